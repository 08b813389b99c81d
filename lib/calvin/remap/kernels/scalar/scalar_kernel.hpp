// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The scalar kernel, which resamples one sample at a time: at borders, over large steps, and for
// layouts that the vector kernels do not know.
#pragma once

#include "calvin/remap/kernels/common/run_row.hpp"
#include "calvin/remap/map/plane_layout.hpp"
#include "calvin/remap/map/plane_map.hpp"

namespace calvin::remap {

// A coordinate that misses the source picture by this, px, is taken as on its border: twice the
// tolerance of the map, with which source coordinates are known.
inline constexpr double kBorderSlack = 2 * RemapMap::kTolerance;

// A part of one row of the output.
struct RowSpan {
  const RunRow& row;  // only x and y of it are used
  int first = 0;      // the sample of the plane that the row's first run begins with
  int begin = 0;      // samples, counted from `first`
  int end = 0;
  const PlaneMap::Row* limits = nullptr;  // where the model is valid; nullptr: everywhere
};

// Resamples the samples of a part of a row. `output.data` is the beginning of the row.
void sample_span(const PlaneMap& map, const PlaneLayout& layout,
                 PlaneMemory<const std::uint8_t> source, PlaneMemory<std::uint8_t> output,
                 const Sampling& sampling, const RowSpan& span) noexcept;

// Writes the fill to the samples of a part of a row.
void fill_span(const PlaneLayout& layout, PlaneMemory<std::uint8_t> output,
               const RowSpan& span) noexcept;

}  // namespace calvin::remap
