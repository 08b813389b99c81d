// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Resampling one sample at a time: borders, wide steps, and whatever the vector kernel lacks.
#pragma once

#include "calvin/remap/kernel.hpp"
#include "calvin/remap/lanes.hpp"

namespace calvin::remap {

// A run of lanes in one row of the output.
struct LaneRun {
  const LaneRow& row;  // its x and y are all that is needed
  int offset = 0;      // lanes from the row's first one to the run's
  int first = 0;       // lane of the plane that the run begins with
  int count = 0;
  const PlaneMap::Row* limits = nullptr;
};

// `output.data` is the beginning of the row.
void sample_lanes(const PlaneMap& map, const PlaneLayout& layout,
                  PlaneMemory<const std::uint8_t> source, PlaneMemory<std::uint8_t> output,
                  const Sampling& sampling, const LaneRun& run) noexcept;

}  // namespace calvin::remap
