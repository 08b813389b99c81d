// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of runs along lines of any slope, and across the borders of the source.
#pragma once

#include <cstdint>

#include "calvin/remap/kernels/common/pixel_layout.hpp"
#include "calvin/remap/kernels/common/run_row.hpp"
#include "calvin/remap/kernels/common/source_bounds.hpp"

namespace calvin::remap {

// A row of the output whose middles are known, and what the source shows there.
struct GatherTask {
  const RunRow& row;
  std::int32_t stride;  // bytes
  AxisEnds x_ends;
  AxisEnds y_ends;
  bool nearest;
  bool fills;          // outside of the source is the fill
  bool mirrors;        // outside of the source is its mirror image; with neither, its border
  std::uint32_t fill;  // a pixel of the fill as it is in memory, in the lowest bytes
  WordFormat format;   // of 16-bit samples
};

// Writes the samples of `count` runs of eight, whose numbers are `runs`. `output` is where the
// first sample of the row's first run goes. left[i] says whether the run runs[i] could not be
// taken: its samples are then undefined. Returns whether there is such a run.
bool gather_runs(PixelLayout layout, const GatherTask& task, const std::int32_t* runs, int count,
                 const std::uint8_t* source, std::uint8_t* output, bool* left) noexcept;

}  // namespace calvin::remap
