// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The scalar kernel, which resamples one sample at a time: at borders, over large steps, and for
// layouts that the vector kernels do not know.
#pragma once

#include "calvin/remap/plane_layout.hpp"
#include "calvin/remap/plane_map.hpp"
#include "calvin/remap/run_row.hpp"

namespace calvin::remap {

// A coordinate that misses the source picture by this, px, is taken as on its border: twice the
// tolerance of the map, with which source coordinates are known.
inline constexpr double kBorderSlack = 2 * RemapMap::kTolerance;

// A part of one row of the output.
struct Stretch {
  const RunRow& row;  // only x and y of it are used
  int first = 0;      // the sample of the plane that the row's first run begins with
  int begin = 0;      // samples, counted from `first`
  int end = 0;
  const PlaneMap::Row* limits = nullptr;  // where the model is valid; nullptr: everywhere
};

// Resamples the samples of a part of a row. `output.data` is the beginning of the row.
void sample_stretch(const PlaneMap& map, const PlaneLayout& layout,
                    PlaneMemory<const std::uint8_t> source, PlaneMemory<std::uint8_t> output,
                    const Sampling& sampling, const Stretch& stretch) noexcept;

// Writes the fill to the samples of a part of a row.
void fill_stretch(const PlaneLayout& layout, PlaneMemory<std::uint8_t> output,
                  const Stretch& stretch) noexcept;

}  // namespace calvin::remap
