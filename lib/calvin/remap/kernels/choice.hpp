// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which of the vector kernels resamples a plane, and what it may read.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "calvin/remap/kernels/bicubic/bicubic_kernel.hpp"
#include "calvin/remap/kernels/common/pixel_layout.hpp"
#include "calvin/remap/kernels/common/source_bounds.hpp"
#include "calvin/remap/map/plane_layout.hpp"
#include "calvin/remap/map/plane_map.hpp"

namespace calvin {

// The samples of a lane for planes of that layout: the length of runs where eight samples are too
// long. PlaneMap::build() asks for this number.
[[nodiscard]] int pixels_per_lane_of(const PlaneLayout& layout) noexcept;

namespace remap {

struct KernelChoice {
  // kNone: the bilinear and gather kernels take no run.
  PixelLayout pixel_layout = PixelLayout::kNone;
  std::optional<BicubicFormat> bicubic;  // absent: not bicubic or Lanczos, or no kernel for it
  SourceBounds bounds;                   // last_row = -1 where neither of them takes the plane
  AxisEnds x_ends;
  AxisEnds y_ends;
};

// `sources` are as for remap_rows().
[[nodiscard]] KernelChoice choose_kernel(
    const PlaneMap& map, const PlaneLayout& layout, const Sampling& sampling,
    std::span<const PlaneMemory<const std::uint8_t>> sources) noexcept;

// How the 16-bit samples of a plane hold their values.
[[nodiscard]] WordFormat word_format(const PlaneLayout& layout) noexcept;

[[nodiscard]] constexpr bool is_words(PixelLayout layout) noexcept {
  return layout == PixelLayout::kOneWord || layout == PixelLayout::kTwoWords;
}

}  // namespace remap

}  // namespace calvin
