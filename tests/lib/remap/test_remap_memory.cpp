// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which memory undistortion reads, and that it does not matter who makes which rows.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "calvin/remap/undistorter.hpp"
#include "remap_reference.hpp"

namespace calvin {
namespace {

using reference::Lens;
using reference::view_of;

const std::vector<Lens> kLenses = {
    {"brown4 barrel", "brown4", {-0.28, 0.09, 5e-4, -7e-4}},
    {"brown4 pincushion", "brown4", {0.12, -0.02, -1e-3, 1e-3}},
    {"fisheye", "fisheye", {-0.02, 0.005, -0.003, 0.0005}},
};

const std::vector<PlaneLayout> kLayouts = {
    {{}, 1, 1, 1},                                                  // GRAY8
    {{1, 1, true, false}, 2, 2, 1},                                 // NV12 chroma
    {{}, 1, 2, 1},                                                  // YUY2 luma
    {{1, 0, true, false}, 2, 4, 2},                                 // its chroma
    {{}, 3, 3, 1},                                                  // RGB
    {{}, 4, 4, 1},                                                  // BGRx
    {{}, 1, 2, 2, {}, SampleType::kU16Little},                      // GRAY16_LE
    {{1, 1, true, false}, 2, 4, 2, {}, SampleType::kU16Little, 6},  // P010 chroma
    // I420 chroma of a part from an odd pixel on
    {{1, 1, true, false, 1, 1}, 1, 1, 1, {}, SampleType::kU8, 0, Subsampling{1, 1, true, false}},
};

const std::vector<ViewOptions> kViews = {view_of(0, 1, 0),     view_of(0.6, 1, 0),
                                         view_of(1, 1, 0),     view_of(0.5, 1, 0.35),
                                         view_of(1, 0.4, 0.1), view_of(1, 0.25, 1.5)};

// Memory between two pages that end the program when they are touched.
class Fenced {
 public:
  explicit Fenced(std::size_t size) : page_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))) {
    inner_ = (size + page_ - 1) / page_ * page_;
    void* all = mmap(nullptr, inner_ + 2 * page_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) std::abort();
    base_ = static_cast<std::uint8_t*>(all);
    if (mprotect(first(), inner_, PROT_READ | PROT_WRITE) != 0) std::abort();
    for (std::size_t i = 0; i < inner_; ++i) first()[i] = static_cast<std::uint8_t>(7 * i + i / 31);
  }
  ~Fenced() { munmap(base_, inner_ + 2 * page_); }
  Fenced(const Fenced&) = delete;
  Fenced& operator=(const Fenced&) = delete;

  [[nodiscard]] std::uint8_t* first() const { return base_ + page_; }
  [[nodiscard]] std::uint8_t* end() const { return first() + inner_; }

 private:
  std::size_t page_;
  std::size_t inner_ = 0;
  std::uint8_t* base_ = nullptr;
};

struct PlaneSize {
  std::ptrdiff_t stride;
  std::size_t bytes;  // to the last sample's last byte
};
PlaneSize size_of(const PlaneLayout& layout, const Subsampling& s, ImageSize frame) {
  const int width = (s.x_before + frame.width + (1 << s.x_shift) - 1) >> s.x_shift;
  const int height = (s.y_before + frame.height + (1 << s.y_shift) - 1) >> s.y_shift;
  const std::ptrdiff_t stride = width * layout.pixel_step;
  const std::ptrdiff_t last = (width - 1) * layout.pixel_step +
                              (layout.components - 1) * layout.component_step +
                              (layout.sample == SampleType::kU8 ? 1 : 2);
  return {stride, static_cast<std::size_t>((height - 1) * stride + last)};
}

std::vector<std::int64_t> instruction_sets() {
#if HWY_ARCH_X86
  // Bits below a target's are those of later instructions.
  return {0, HWY_AVX3 - 1, HWY_AVX2 - 1, HWY_SSE4 - 1};
#else
  return {0};
#endif
}

TEST(RemapMemory, NothingBesideAPlaneIsRead) {
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{331, 243}, ImageSize{1280, 96}}) {
    for (const Lens& lens : kLenses) {
      const double focal = 0.55 * size.width;
      const Camera source =
          reference::camera(lens, size, focal, 0.5 * size.width, 0.49 * size.height);
      for (const ViewOptions& view : kViews) {
        const auto undistorter = Undistorter::make(source, view, kLayouts);
        ASSERT_TRUE(undistorter.has_value());
        for (std::size_t i = 0; i < kLayouts.size(); ++i) {
          const PlaneSites sites = kLayouts[i].sites();
          const PlaneSize in = size_of(kLayouts[i], sites.source, size);
          const PlaneSize out = size_of(kLayouts[i], sites.output, size);
          const Fenced input(in.bytes);
          const Fenced output(out.bytes);
          for (const std::int64_t disabled : instruction_sets()) {
            hwy::DisableTargets(disabled);
            for (const auto way : {Interpolation::kNearest, Interpolation::kBilinear}) {
              // Flush with the pages before and behind.
              undistorter->apply(i, {input.first(), in.stride}, {output.first(), out.stride},
                                 {way});
              undistorter->apply(i, {input.end() - in.bytes, in.stride},
                                 {output.end() - out.bytes, out.stride}, {way});
            }
            hwy::DisableTargets(0);
          }
        }
      }
    }
  }
}

TEST(RemapMemory, SharesOfTheRowsMakeTheSamePicture) {
  const ImageSize size = {640, 480};
  const Camera source = reference::camera(kLenses[0], size, 380, 322, 237);
  for (const PlaneLayout& layout : kLayouts) {
    const Undistorter undistorter = Undistorter::make(source, {0.5, {}}, {layout}).value();
    const PlaneSize in = size_of(layout, layout.sites().source, size);
    const PlaneSize out = size_of(layout, layout.sites().output, size);
    const Fenced input(in.bytes);
    std::vector<std::uint8_t> whole(out.bytes);
    std::vector<std::uint8_t> shared(out.bytes);
    undistorter.apply(0, {input.first(), in.stride}, {whole.data(), out.stride});
    const std::vector<PlaneMemory<const std::uint8_t>> sources = {{input.first(), in.stride}};
    const std::vector<PlaneMemory<std::uint8_t>> outputs = {{shared.data(), out.stride}};
    constexpr int kParts = 7;
    for (int part = 0; part < kParts; ++part) {
      undistorter.apply(sources, outputs, {}, part, kParts);
    }
    EXPECT_EQ(whole, shared);
  }
}

// A scratch that has seen wider rows, other layouts, lenses and kernels beside one that has not.
TEST(RemapMemory, WhatAWorkerHasNotedBeforeChangesNoPicture) {
  Undistorter::Scratch kept;
  for (const ImageSize size : {ImageSize{2300, 40}, ImageSize{331, 243}}) {
    for (const Lens& lens : kLenses) {
      const Camera source =
          reference::camera(lens, size, 0.55 * size.width, 0.5 * size.width, 0.49 * size.height);
      for (const PlaneLayout& layout : kLayouts) {
        const Undistorter undistorter = Undistorter::make(source, {0.5, {}}, {layout}).value();
        const PlaneSize in = size_of(layout, layout.sites().source, size);
        const PlaneSize out = size_of(layout, layout.sites().output, size);
        const Fenced input(in.bytes);
        const std::vector<PlaneMemory<const std::uint8_t>> sources = {{input.first(), in.stride}};
        for (const auto way :
             {Interpolation::kNearest, Interpolation::kBilinear, Interpolation::kBicubic}) {
          std::vector<std::uint8_t> alone(out.bytes);
          std::vector<std::uint8_t> after(out.bytes);
          undistorter.apply(0, sources[0], {alone.data(), out.stride}, {way});
          const std::vector<PlaneMemory<std::uint8_t>> outputs = {{after.data(), out.stride}};
          undistorter.apply(sources, outputs, {way}, 0, 1, kept);
          EXPECT_EQ(alone, after) << lens.name << ", " << layout.pixel_step << " bytes a pixel";
        }
      }
    }
  }
}

}  // namespace
}  // namespace calvin
