// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which of the vector kernels resamples a plane, and what it may read.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "calvin/remap/kernel.hpp"
#include "calvin/remap/lanes.hpp"

namespace calvin::remap {

struct KernelChoice {
  LaneLayout lanes = LaneLayout::kNone;
  std::optional<WideFormat> wide;
  SourceBounds bounds;  // without rows where there is no such kernel
  AxisEnds x_ends;
  AxisEnds y_ends;
};

// `sources` are as for remap_rows().
[[nodiscard]] KernelChoice choose_kernel(
    const PlaneMap& map, const PlaneLayout& layout, const Sampling& sampling,
    std::span<const PlaneMemory<const std::uint8_t>> sources) noexcept;

// Of 16-bit samples.
[[nodiscard]] WordFormat word_format(const PlaneLayout& layout) noexcept;

[[nodiscard]] constexpr bool is_words(LaneLayout layout) noexcept {
  return layout == LaneLayout::kOneWord || layout == LaneLayout::kTwoWords;
}

}  // namespace calvin::remap
