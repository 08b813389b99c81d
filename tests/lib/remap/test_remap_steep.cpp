// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views that are turned or much smaller than the source: their rows cross many rows of the source.
#include <algorithm>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "remap_planes.hpp"

namespace calvin {
namespace {

using namespace remap_planes;

struct NamedView {
  const char* name;
  ViewOptions options;
};

const std::vector<NamedView> kViews = {
    {"rolled by 10 degrees", reference::view_of(0, 1, 0.17)},
    {"by 20", reference::view_of(1, 1, 0.35)},
    {"by 45", reference::view_of(0.5, 1, 0.79)},
    {"by 90", reference::view_of(1, 1, 1.57)},
    {"upside down", reference::view_of(0.5, 1, 3.1)},
    {"half the size", reference::view_of(0.5, 0.5, 0)},
    {"a third", reference::view_of(0.5, 0.33, 0.1)},
    {"a fifth", reference::view_of(1, 0.2, -0.3)},
    {"four times the size", reference::view_of(0, 4, 0.3)},
};

class RemapSteep : public ::testing::TestWithParam<ImageSize> {};

TEST_P(RemapSteep, EqualsBilinearInDoublePrecisionWithinOneGreyLevel) {
  const ImageSize size = GetParam();
  const Lens& lens = kLenses[3];
  const Camera source =
      reference::camera(lens, size, 0.75 * size.width, 0.51 * size.width, 0.485 * size.height);
  for (const NamedView& view : kViews) {
    const Undistorter undistorter = undistorter_for(source, view.options);
    const Eigen::Matrix3d turn = camera_from_view(view.options);
    // A pinhole camera that looks where the view does, and the source with its lens.
    const Camera& output = undistorter.output();
    const auto place_of = [&](double x, double y) {
      const Eigen::Vector3d ray = turn * Eigen::Vector3d((x - output.cx()) / output.fx(),
                                                         (y - output.cy()) / output.fy(), 1);
      const double u = ray.x() / ray.z() * output.fx() + output.cx();
      const double v = ray.y() / ray.z() * output.fy() + output.cy();
      return reference::source_place(lens, source, output, u, v);
    };
    for (std::size_t i = 0; i < kLayouts.size(); ++i) {
      const NamedLayout& named = kLayouts[i];
      SCOPED_TRACE(std::string(view.name) + ", " + named.name);
      const Planes planes = undistort(undistorter, i);
      const Comparison result = compare(lens, size, place_of, named, planes);
      const double rounding = 127.5 / named.max;
      EXPECT_LE(result.worst, rounding + 0.5);
      EXPECT_LE(result.sum, result.valid * (rounding / 2 + 0.26));
      EXPECT_EQ(result.wrong_fill, 0);
      EXPECT_EQ(result.bytes_harmed, 0);
      EXPECT_GT(result.valid, 200);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RemapSteep,
                         ::testing::Values(ImageSize{641, 479}, ImageSize{962, 542}),
                         [](const auto& size) { return std::to_string(size.param.width); });

#if HWY_ARCH_X86
TEST(RemapSteepKernels, EveryInstructionSetGivesTheSame) {
  const ImageSize size = {450, 254};
  const Camera source = reference::camera(kLenses[1], size, 337, 226, 126);
  for (const NamedView& view : kViews) {
    const Undistorter undistorter = undistorter_for(source, view.options);
    for (std::size_t l = 0; l < kLayouts.size(); ++l) {
      const Sampling sampling = {Interpolation::kBilinear, Outside::kReplicate};
      const Planes best = undistort(undistorter, l, sampling);
      const NamedLayout& named = kLayouts[l];
      const ImageSize samples = output_size(size, named);
      // Bits below a target's are those of later instructions.
      for (const auto target : {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_SSSE3, HWY_STATIC_TARGET}) {
        SCOPED_TRACE(std::string(view.name) + ", " + named.name + " " + hwy::TargetName(target));
        hwy::DisableTargets(static_cast<std::int64_t>(target) - 1);
        const Planes planes = undistort(undistorter, l, sampling);
        hwy::DisableTargets(0);
        EXPECT_EQ(count_apart(best, planes, named, samples, std::max(1.0, 1.5 * named.max / 255)),
                  0);
      }
    }
  }
}
#endif

}  // namespace
}  // namespace calvin
