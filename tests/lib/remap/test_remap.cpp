// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pixels of an undistorted picture against a reference in double precision.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "lens_samples.hpp"
#include "remap_planes.hpp"

namespace calvin {
namespace {

using namespace remap_planes;
using reference::Lens;

class RemapPlane : public ::testing::TestWithParam<ImageSize> {};

TEST_P(RemapPlane, EqualsBilinearInDoublePrecisionWithinOneGreyLevel) {
  const ImageSize size = GetParam();
  for (const Lens& lens : kLenses) {
    const double focal = lens.model == "fisheye" ? 0.42 * size.width : 0.75 * size.width;
    const Camera source =
        reference::camera(lens, size, focal, 0.51 * size.width, 0.485 * size.height);
    for (const double alpha : {0.0, 1.0}) {
      const Undistorter undistorter = undistorter_for(source, alpha);
      for (std::size_t i = 0; i < kLayouts.size(); ++i) {
        const NamedLayout& named = kLayouts[i];
        SCOPED_TRACE(lens.name + ", " + named.name + ", alpha " + std::to_string(alpha));
        const Planes planes = undistort(undistorter, i);
        const Comparison result = compare(lens, undistorter, named, planes);
        // Half a level of rounding to the sample's depth; noise is as sharp as can be, and half a
        // level more is 0.001 px each way.
        const double rounding = 127.5 / named.max;
        EXPECT_LE(result.smooth, rounding + 0.1);
        EXPECT_LE(result.worst, rounding + 0.5);
        // Rounding alone makes 1/4.
        EXPECT_LE(result.sum, result.valid * (rounding / 2 + 0.26));
        EXPECT_EQ(result.wrong_fill, 0);
        EXPECT_EQ(result.bytes_harmed, 0);
        EXPECT_GT(result.valid, size.width * size.height / 30);
        EXPECT_EQ(result.filled > 0, alpha == 1 && !lens.k.empty());
      }
    }
  }
}

// There the map has fewer nodes, and the rows between them more in common.
TEST(RemapLarge, EqualsBilinearInDoublePrecisionWithinOneGreyLevel) {
  const ImageSize size = {3840, 2160};
  for (const Lens& lens : kLenses) {
    const double focal = lens.model == "fisheye" ? 0.42 * size.width : 0.75 * size.width;
    const Undistorter undistorter = undistorter_for(
        reference::camera(lens, size, focal, 0.51 * size.width, 0.485 * size.height), 0.4);
    for (const std::size_t i : {0, 5}) {
      const NamedLayout& named = kLayouts[i];
      SCOPED_TRACE(lens.name + ", " + named.name);
      const Comparison result =
          compare(lens, undistorter, named, undistort(undistorter, i), 23 * kRowStep);
      EXPECT_LE(result.worst, 1);
      EXPECT_LE(result.sum, result.valid * 0.51);
      EXPECT_EQ(result.wrong_fill, 0);
      EXPECT_EQ(result.bytes_harmed, 0);
      EXPECT_GT(result.valid, 10000);
    }
  }
}

TEST_P(RemapPlane, AnIdentityCalibrationGivesIdenticalPixels) {
  const ImageSize size = GetParam();
  const std::vector<Lens> identities = {{"pinhole", "pinhole", {}},
                                        {"brown5", "brown5", {0, 0, 0, 0, 0}}};
  for (const Lens& lens : identities) {
    const Camera source = reference::camera(lens, size, 503.7, 300.2, 251.9);
    for (const double alpha : {0.0, 0.37, 1.0}) {
      const Undistorter undistorter = undistorter_for(source, alpha);
      for (std::size_t i = 0; i < kLayouts.size(); ++i) {
        if (kLayouts[i].layout.output_subsampling) continue;  // moves the samples
        SCOPED_TRACE(lens.name + ", " + kLayouts[i].name + ", alpha " + std::to_string(alpha));
        const Planes planes = undistort(undistorter, i);
        EXPECT_EQ(planes.input.bytes, planes.output.bytes);
      }
    }
  }
}

// 16 bits tell what single precision loses far from the origin.
TEST(RemapIdentity, AWidePictureStaysAsItIs) {
  const Lens lens = {"brown5", "brown5", {0, 0, 0, 0, 0}};
  for (const ImageSize size : {ImageSize{4103, 34}, ImageSize{66, 2051}}) {
    const Undistorter undistorter =
        undistorter_for(reference::camera(lens, size, 903.7, 1300.2, 21.9), 0.37);
    for (std::size_t i = 0; i < kLayouts.size(); ++i) {
      if (kLayouts[i].layout.output_subsampling) continue;  // moves the samples
      SCOPED_TRACE(std::string(kLayouts[i].name) + ", " + std::to_string(size.width));
      const Planes planes = undistort(undistorter, i);
      EXPECT_EQ(planes.input.bytes, planes.output.bytes);
    }
  }
}

TEST_P(RemapPlane, BicubicAndLanczosEqualDoublePrecisionWithinOneGreyLevel) {
  const ImageSize size = GetParam();
  const Lens& lens = kLenses[1];
  const Camera source =
      reference::camera(lens, size, 0.75 * size.width, 0.51 * size.width, 0.485 * size.height);
  const Undistorter undistorter = undistorter_for(source, 0.3);
  for (std::size_t l = 0; l < kLayouts.size(); ++l) {
    const NamedLayout& named = kLayouts[l];
    if (named.layout.output_subsampling) continue;
    const PlaneLayout& layout = named.layout;
    const Subsampling& s = layout.subsampling;
    const auto xs = reference::sites(size.width, s.x_shift, s.x_cosited);
    const auto ys = reference::sites(size.height, s.y_shift, s.y_cosited);
    const int width = static_cast<int>(xs.size());
    const int height = static_cast<int>(ys.size());
    for (const auto interpolation : {Interpolation::kBicubic, Interpolation::kLanczos}) {
      SCOPED_TRACE(std::string(named.name) +
                   (interpolation == Interpolation::kLanczos ? " 3" : ""));
      const Planes planes = undistort(undistorter, l, {interpolation, Outside::kFill});
      double worst = 0;
      for (int j = 0; j < height; j += 3 * kRowStep) {
        for (int i = 0; i < width; ++i) {
          const Pixel at =
              reference::source_place(lens, source, undistorter.output(), xs[i], ys[j]).pixel;
          const double inside =
              std::min({at.u, at.v, size.width - 1 - at.u, size.height - 1 - at.v});
          if (inside < 4e-3) continue;
          for (int c = 0; c < layout.components; ++c) {
            const auto offset = i * layout.pixel_step + c * layout.component_step;
            const auto read = [&](int x, int y) {
              return read_sample(planes.input.bytes.data() + y * planes.input.stride +
                                     x * layout.pixel_step + c * layout.component_step,
                                 layout);
            };
            const double x = reference::sample_at(xs, at.u);
            const double y = reference::sample_at(ys, at.v);
            const double exact =
                interpolation == Interpolation::kBicubic
                    ? reference::filtered(read, reference::cubic, width, height, x, y)
                    : reference::filtered(read, reference::lanczos3, width, height, x, y);
            const int got =
                read_sample(planes.output.bytes.data() + j * planes.output.stride + offset, layout);
            worst = std::max(worst, std::abs(got - std::clamp(exact, 0.0, 1.0 * named.max)));
          }
        }
      }
      // Rounding, and a level of 8 bit.
      EXPECT_LE(worst, 0.5 + named.max / 255.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RemapPlane,
                         ::testing::Values(ImageSize{641, 479}, ImageSize{322, 242},
                                           ImageSize{255, 193}),
                         [](const auto& size) { return std::to_string(size.param.width); });

#if HWY_ARCH_X86
// The one that the machine takes is compared with the reference above.
TEST(RemapKernels, EveryInstructionSetGivesTheSame) {
  const ImageSize size = {322, 242};
  const Camera source = reference::camera(kLenses[3], size, 240, 160, 119);
  const Undistorter undistorter = undistorter_for(source, 0.4);
  for (std::size_t l = 0; l < kLayouts.size(); ++l) {
    const NamedLayout& named = kLayouts[l];
    const ImageSize samples = output_size(size, named);
    for (const auto interpolation : {Interpolation::kNearest, Interpolation::kBilinear,
                                     Interpolation::kBicubic, Interpolation::kLanczos}) {
      const Sampling sampling = {interpolation, Outside::kReplicate};
      const Planes best = undistort(undistorter, l, sampling);
      // Bits below a target's are those of later instructions.
      for (const auto target : {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_SSSE3, HWY_STATIC_TARGET}) {
        SCOPED_TRACE(std::string(named.name) + " " + hwy::TargetName(target));
        hwy::DisableTargets(static_cast<std::int64_t>(target) - 1);
        const Planes planes = undistort(undistorter, l, sampling);
        hwy::DisableTargets(0);
        // Between two samples the nearest is whichever rounding takes.
        const bool is_nearest = interpolation == Interpolation::kNearest;
        const double allowed = is_nearest ? 0 : std::max(1.0, 1.5 * named.max / 255);
        EXPECT_LE(count_apart(best, planes, named, samples, allowed), is_nearest ? 200 : 0);
      }
    }
  }
}
#endif

TEST(RemapMap, StaysInsideThePlaneForExtremeCalibrations) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-3, 6);
  std::uniform_real_distribution<double> sign(-1, 1);
  const auto number = [&] { return (sign(random) < 0 ? -1 : 1) * std::pow(10, exponent(random)); };
  const ImageSize size = {50, 38};
  int made = 0;
  for (int i = 0; i < 60; ++i) {
    const Lens& shape = kLenses[static_cast<std::size_t>(i) % kLenses.size()];
    std::vector<double> p = {std::abs(number()), std::abs(number()), number(), number()};
    for (std::size_t k = 0; k < shape.k.size(); ++k) p.push_back(number());
    const auto source = Camera::make(shape.model, size, p);
    ASSERT_TRUE(source.has_value());
    for (const double alpha : {0.0, 0.5, 1.0}) {
      const auto output = output_camera(*source, {alpha, {}});
      if (!output) {
        EXPECT_FALSE(output.error().message.empty());
        continue;
      }
      ++made;
      for (const double value : output->parameters()) ASSERT_TRUE(std::isfinite(value));
      const Undistorter undistorter = undistorter_for(*source, alpha);
      for (std::size_t l = 0; l < kLayouts.size(); ++l) {
        // The rows end where the memory does.
        const Planes planes = undistort(undistorter, l);
        const auto padding = planes.output.bytes.end() - 13;
        EXPECT_TRUE(std::all_of(padding, padding + 13, [](auto byte) { return byte == 0xA5; }));
      }
    }
  }
  EXPECT_GT(made, 20);
}

TEST(RemapMap, ATinyPictureIsRefusedOrMapped) {
  for (const ImageSize size :
       {ImageSize{1, 1}, ImageSize{2, 1}, ImageSize{1, 5}, ImageSize{2, 2}, ImageSize{3, 3}}) {
    const Camera source = Camera::make("pinhole", size, {5, 5, 0.5, 0.5}).value();
    const auto undistorter = Undistorter::make(source, {}, {kLayouts[2].layout});
    EXPECT_EQ(undistorter.has_value(), size.width > 1 && size.height > 1) << size.width;
  }
}

TEST(RemapMap, LeadsThroughEveryLensAsItProjects) {
  const ImageSize size = {320, 240};
  const Lens no_fold = {"pinhole", "pinhole", {}};
  for (const LensTraits& lens : all_lenses()) {
    for (const auto& coefficients : samples::lens(lens.model).coefficients) {
      SCOPED_TRACE(std::string(lens.model) + ::testing::PrintToString(coefficients));
      const double focal = (lens.perspective ? 0.8 : 0.45) * size.width;
      std::vector<double> parameters = {focal, 0.98 * focal, 162, 117};
      parameters.insert(parameters.end(), coefficients.begin(), coefficients.end());
      const Camera source = Camera::make(lens.model, size, parameters).value();
      const Undistorter undistorter = undistorter_for(source, 0);
      const Camera& output = undistorter.output();
      const auto place_of = [&](double u, double v) -> reference::Place {
        const auto at =
            source.project({(u - output.cx()) / output.fx(), (v - output.cy()) / output.fy(), 1});
        return {at.value_or(Pixel{-1e3, -1e3}), 0};
      };
      const Comparison result =
          compare(no_fold, size, place_of, kLayouts[0], undistort(undistorter, 0));
      EXPECT_LE(result.worst, 1);
      EXPECT_EQ(result.wrong_fill, 0);
      EXPECT_GT(result.valid, size.width * size.height / 4);
    }
  }
}

TEST(RemapMap, StopsWhenAsked) {
  const Camera source = reference::camera(kLenses[1], {640, 480}, 480, 320, 240);
  std::stop_source stop;
  stop.request_stop();
  const auto undistorter = Undistorter::make(source, {}, {kLayouts[0].layout}, stop.get_token());
  ASSERT_FALSE(undistorter.has_value());
  EXPECT_EQ(undistorter.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace calvin
