// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of one plane of samples, by memory layout and not by format.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "calvin/remap/map.hpp"

namespace calvin {

// How one sample lies in memory.
enum class SampleType : std::uint8_t { kU8, kU16Little, kU16Big };

// 1 to 4 components that share their places: the luma of a YUV frame, the chroma pair of NV12,
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

  [[nodiscard]] PlaneSites sites() const noexcept {
    return {subsampling, output_subsampling.value_or(subsampling)};
  }
};

// The first component of the first sample of a plane, and the bytes from a row to the next.
template <typename Byte>
struct PlaneMemory {
  Byte* data = nullptr;
  std::ptrdiff_t stride = 0;
};

// Writes every sample of the output plane, `map.size()` of them. `layout.sites()` are the ones the
// map was built with; `source` holds the plane that the map reads from and does not overlap
// `output`. Every component is interpolated by itself, alpha too. Differs from bilinear
// interpolation in exact arithmetic by 1/1024 of the largest value and by rounding: by less than
// one level of 8 bit, whatever the depth.
void remap_plane(const RemapMap& map, const PlaneLayout& layout,
                 PlaneMemory<const std::uint8_t> source, PlaneMemory<std::uint8_t> output) noexcept;

}  // namespace calvin
