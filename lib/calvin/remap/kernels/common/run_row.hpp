// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One row of an output plane as runs: where they lie in the source, and which kernel takes each.
#pragma once

#include <array>
#include <cstdint>

#include "calvin/remap/map/runs.hpp"

namespace calvin::remap {

// Runs that are worked on at a time: the arrays of a chunk stay in the nearest cache.
inline constexpr int kChunkRuns = 256;

// Marks in RunRow::rows. A run that the bilinear kernel cannot take is slow; one that shows nothing
// but the fill is empty as well; kSlowGroup says that all runs of the group are slow. The marks lie
// above the number of rows (at most 15) and the marks of bands below.
inline constexpr std::int32_t kSlowRun = 64;
inline constexpr std::int32_t kEmptyRun = 128;
inline constexpr std::int32_t kSlowGroup = 256;

// Added to the number of rows where a band has prepared the samples of a run (a steady run).
inline constexpr std::int32_t kSteadyRows = 32;
inline constexpr std::int32_t kSteadyThree = kSteadyRows + 3;
[[nodiscard]] constexpr bool is_steady(std::int32_t rows) noexcept {
  return (rows & kSteadyRows) != 0;
}

// Added to the number of rows where windows into three rows of the source hold all pixels of a
// steady run, in every row of the band.
inline constexpr std::int32_t kWindowRows = 16;
[[nodiscard]] constexpr bool is_window(std::int32_t rows) noexcept {
  return (rows & kWindowRows) != 0;
}

// A set of blocks of 16 runs, a bit each: blocks that are not in the set have no slow run.
inline constexpr int kSlowBlockRuns = 16;
using SlowBlocks = std::uint32_t;
inline constexpr SlowBlocks kAllSlow = ~SlowBlocks{0};
[[nodiscard]] constexpr SlowBlocks slow_block(int run) noexcept {
  return SlowBlocks{1} << (run / kSlowBlockRuns);
}

// The middles of a chunk of runs, and of its margins, at four rows of the map's nodes, in 1/2^14 of
// a sample. The first run of the chunk is at kFirst, so that vectors of runs are aligned; the 48
// more are the margins and what vectors read beyond them.
struct NodeRows {
  static constexpr int kFirst = 16;
  static constexpr int kRuns = kChunkRuns + 48;
  alignas(64) float x[4][kRuns];
  alignas(64) float y[4][kRuns];
};

// A row of the output between four rows of nodes: the first one, plus these parts of the
// differences between the others and the first one. Coordinates that are equal in all four thus
// come out as they are, without rounding.
struct RowBetweenNodes {
  const NodeRows& nodes;
  std::array<float, 4> weights;
};

// A chunk of runs at one row of the output. Fixed-point numbers are written as m.n: 16 bits, n of
// them behind the point.
struct RunRow {
  static constexpr int kRuns = NodeRows::kRuns;
  // Where the samples of a run fill several lanes, each of these parts may have a segment of its
  // own: at most four, for eight pairs of 16-bit samples.
  static constexpr int kMaxParts = 4;
  // The middles of the runs, margins included, in 1/2^14 of a sample.
  alignas(64) std::int32_t x[kRuns];
  alignas(64) std::int32_t y[kRuns];
  // The arrays below have no margins: [0] is the first run.
  // Bytes from the beginning of the plane to the segment: the bytes of the first source row, 16 or
  // more, that hold all samples which the run needs of this row.
  alignas(64) std::int32_t offset[kRuns];
  // The rows of the source that the run's group reads, and the marks above.
  alignas(64) std::int32_t rows[kRuns];
  // Records of two 16-bit numbers, x in the low half and y in the high one. Where a run takes three
  // rows, y is counted from the middle row and is eight times as large.
  alignas(64) std::int32_t slope[kRuns];  // 2.14
  alignas(64) std::int32_t bend[kRuns];   // 4.12: what the parabola adds at the ends of the run
  // The middle of the run, counted from the first sample of the segment; 4.12. By part, kParts
  // records per run.
  alignas(64) std::int32_t middle[kMaxParts * kRuns];
  // As `offset`, by part; only where there are several parts.
  alignas(64) std::int32_t part_offset[kMaxParts * kRuns];
  int count = 0;  // runs
};

}  // namespace calvin::remap
