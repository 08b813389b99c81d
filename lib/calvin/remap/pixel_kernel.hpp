// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Resampling one sample at a time: borders, wide steps, and whatever the vector kernel lacks.
#pragma once

#include "calvin/remap/plane_layout.hpp"
#include "calvin/remap/plane_map.hpp"
#include "calvin/remap/run_row.hpp"

namespace calvin::remap {

// px; what misses the picture by that is on its border: places are known no better.
inline constexpr double kBorderSlack = 2 * RemapMap::kTolerance;

// A part of one row of the output.
struct Stretch {
  const RunRow& row;  // its x and y are all that is needed
  int first = 0;      // sample of the plane that the row's first run begins with
  int begin = 0;      // samples from there
  int end = 0;
  const PlaneMap::Row* limits = nullptr;
};

// `output.data` is the beginning of the row.
void sample_stretch(const PlaneMap& map, const PlaneLayout& layout,
                    PlaneMemory<const std::uint8_t> source, PlaneMemory<std::uint8_t> output,
                    const Sampling& sampling, const Stretch& stretch) noexcept;

// Fills the samples of a stretch.
void fill_stretch(const PlaneLayout& layout, PlaneMemory<std::uint8_t> output,
                  const Stretch& stretch) noexcept;

}  // namespace calvin::remap
