// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear and nearest-neighbour resampling of rows of runs: a band is begun, each of its rows is
// described (where does each run lie in the source?), and the rows are blended (what is there?).
#pragma once

#include <cstdint>

#include "calvin/remap/kernels/bilinear/band.hpp"
#include "calvin/remap/kernels/common/pixel_layout.hpp"
#include "calvin/remap/kernels/common/run_row.hpp"
#include "calvin/remap/kernels/common/source_bounds.hpp"

namespace calvin::remap {

// Planes that share their source coordinates: the U and V of I420.
inline constexpr int kMaxPlanes = 2;
struct PlaneRows {
  const std::uint8_t* source[kMaxPlanes];
  std::uint8_t* output[kMaxPlanes];
  int planes = 1;
};

// Writes the middles of the first `runs` of the chunk, and of its margins, in 1/2^14 of a sample.
void interpolate_runs(const RowBetweenNodes& between, int runs, std::int32_t* x,
                      std::int32_t* y) noexcept;

// Prepares what the rows of a band share, for runs of `run` samples. The middles in the band's
// first row, in its last row and half way are known. All rows lie between the same two of the
// nodes' rows; `slot` is the first of the four rows of `nodes` in their order down the map,
// `height` the height of the band in the distance of two rows of nodes. Returns whether every run
// is steady or empty: then no row of the band needs its middles.
bool begin_band(PixelLayout layout, int run, const SourceBounds& bounds, const NodeRows& nodes,
                int slot, float height, Band& band, RunRow& row) noexcept;

// Fills in a row, for runs of `run` samples: eight, or as many pixels as a lane has. Returns the
// blocks that have slow runs. `between` interpolates the middles of those runs that are not steady;
// it is nullptr where all middles are known already, or no run needs them. `band_fraction` is as in
// RowTask.
using DescribeRuns = SlowBlocks (*)(const SourceBounds& bounds, const RowBetweenNodes* between,
                                    const Band& band, float band_fraction, RunRow& row);
[[nodiscard]] DescribeRuns run_describer(PixelLayout layout, int run, bool strongly_bent) noexcept;

// A row whose runs are described.
struct RowTask {
  const RunRow& row;
  const Band& band;
  float band_fraction;  // the fraction of the band's height that lies above the row, 0..1
  std::int32_t stride;  // bytes, of the source
  bool nearest;
  WordFormat format;  // of 16-bit samples
};

// Writes the samples of the runs from `begin` to before `end`, in groups of run_group(). Groups of
// slow runs are left out. A slow run in another group gets undefined samples, and so do the
// run_slack() bytes behind a group: they have to be written afterwards. `planes.output` is where
// the run `begin` goes.
using BlendRuns = void (*)(const RowTask& task, int begin, int end, const PlaneRows& planes);
[[nodiscard]] BlendRuns run_blender(PixelLayout layout, int run, bool nearest, int planes) noexcept;

// The runs that the kernel takes at a time on this machine: 1, 2, 4 or 8.
[[nodiscard]] int run_group(PixelLayout layout, int run) noexcept;

}  // namespace calvin::remap
