// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the samples of a plane lie in memory, and how they are to be interpolated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "calvin/remap/map/sampling.hpp"

namespace calvin {

// How one sample lies in memory.
enum class SampleType : std::uint8_t { kU8, kU16Little, kU16Big };

// 1 to 4 components that share their positions: the luma of a YUV frame, the chroma pair of NV12,
// the four bytes of BGRx.
struct PlaneLayout {
  Subsampling subsampling;
  int components = 1;
  std::ptrdiff_t pixel_step = 1;        // bytes from a sample to the next: 2 for the luma of YUY2
  std::ptrdiff_t component_step = 1;    // bytes from a component to the next: 2 for its chroma
  std::array<std::uint16_t, 4> fill{};  // of each component where the source has nothing to show
  SampleType sample = SampleType::kU8;
  int shift = 0;  // of 16-bit samples: the bits below the value, written as 0: 6 for P010
  // Where the output's samples lie; absent: as the source's.
  std::optional<Subsampling> output_subsampling = std::nullopt;
  int bits = 0;  // of the value of a 16-bit sample; 0: all above the shift

  [[nodiscard]] PlaneSites sites() const noexcept {
    return {subsampling, output_subsampling.value_or(subsampling)};
  }
  friend bool operator==(const PlaneLayout&, const PlaneLayout&) = default;
};

// The first component of the first sample of a plane, and the bytes from a row to the next.
template <typename Byte>
struct PlaneMemory {
  Byte* data = nullptr;
  std::ptrdiff_t stride = 0;
};

enum class Interpolation : std::uint8_t { kNearest, kBilinear, kBicubic, kLanczos };

// What is shown outside of the source picture: `fill` of the layout, the nearest pixel of its
// border, or the picture again, mirrored at its border pixels. Where the camera model is not valid
// there is nothing but the fill.
enum class Outside : std::uint8_t { kFill, kReplicate, kMirror };

struct Sampling {
  Interpolation interpolation = Interpolation::kBilinear;
  Outside outside = Outside::kFill;

  friend bool operator==(const Sampling&, const Sampling&) = default;
};

}  // namespace calvin
