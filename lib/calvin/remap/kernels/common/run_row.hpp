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

// What is known of a run: a bit each, above the four bits of source_rows().
enum class RunMark : std::int32_t {
  kWindows = 1 << 4,    // steady; in every row of the band three windows hold all of its pixels
  kSteady = 1 << 5,     // the band has prepared the samples of the run
  kSlow = 1 << 6,       // the bilinear kernel cannot take the run
  kEmpty = 1 << 7,      // slow; the run shows nothing but the fill
  kSlowGroup = 1 << 8,  // slow; so are all runs of its group
};

// The marks of a run, and how many rows of the source its group reads. It is a plain number because
// vectors are made of it.
using RunMarks = std::int32_t;
[[nodiscard]] constexpr RunMarks bit(RunMark mark) noexcept { return static_cast<RunMarks>(mark); }
[[nodiscard]] constexpr RunMarks operator|(RunMarks marks, RunMark mark) noexcept {
  return marks | bit(mark);
}
[[nodiscard]] constexpr RunMarks operator|(RunMark a, RunMark b) noexcept { return bit(a) | b; }
[[nodiscard]] constexpr bool has(RunMarks marks, RunMark mark) noexcept {
  return (marks & bit(mark)) != 0;
}
[[nodiscard]] constexpr int source_rows(RunMarks marks) noexcept { return marks & 15; }

// The most frequent marks; and those of a group that the bilinear kernel leaves out.
inline constexpr RunMarks kSteadyThree = 3 | RunMark::kSteady;
inline constexpr RunMarks kLeftOut = RunMark::kSlow | RunMark::kSlowGroup;

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
  alignas(64) RunMarks marks[kRuns];
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
