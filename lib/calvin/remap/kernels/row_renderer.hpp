// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Resampling of the rows of one plane, by memory layout and not by format: the row renderer.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "calvin/remap/kernels/bilinear/band.hpp"
#include "calvin/remap/kernels/common/run_row.hpp"
#include "calvin/remap/map/plane_layout.hpp"
#include "calvin/remap/map/plane_map.hpp"

namespace calvin {

namespace remap {

// What remap_rows() notes of the chunk of runs that it takes down the rows: 73 KB, which a worker
// keeps for all its rows, planes and frames. No chunk reads what another one has left there.
struct RowScratch {
  NodeRows nodes;
  Band band;
  RunRow row;
  std::array<std::int32_t, kChunkRuns> slow_runs;  // those of a row that the gather kernel is given
  std::array<bool, kChunkRuns> left;               // of these: those that it leaves
};

}  // namespace remap

// Writes the rows begin..end-1 of output planes that all have this layout and one map, made for
// `layout.sites()`: one plane, or two, which costs less than one after the other. `sources` hold
// the planes that the map reads from and do not overlap `outputs`. Every component is interpolated
// by itself, alpha too. What `scratch` holds before does not matter.
//
// Source coordinates are right to about 1/1000 px and weights to 1/4096: against double precision
// that is at most one grey level of 8 bit, even in noise. Bicubic is Catmull-Rom's, Lanczos has
// three lobes; both keep to the range of the samples.
void remap_rows(const PlaneMap& map, const PlaneLayout& layout,
                std::span<const PlaneMemory<const std::uint8_t>> sources,
                std::span<const PlaneMemory<std::uint8_t>> outputs, const Sampling& sampling,
                int begin, int end, remap::RowScratch& scratch) noexcept;

}  // namespace calvin
