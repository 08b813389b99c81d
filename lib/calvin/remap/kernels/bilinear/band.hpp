// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the rows of a band share, so that it is computed once for all of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>

#include "calvin/remap/kernels/common/run_row.hpp"

namespace calvin::remap {

// The runs of a chunk in the first and the last row of a band, and how to interpolate them in the
// rows between. A run is steady where it is well inside the source in all rows, and its slope and
// bend change linearly from the first row to the last.
struct Band {
  static constexpr int kRuns = RunRow::kRuns;
  static constexpr int kSamples = 8 * kRuns;
  // The middles of the runs, margins included, in the first row, in the last row, and half way.
  alignas(64) std::int32_t x_first[kRuns];
  alignas(64) std::int32_t y_first[kRuns];
  alignas(64) std::int32_t x_last[kRuns];
  alignas(64) std::int32_t y_last[kRuns];
  alignas(64) std::int32_t x_halfway[kRuns];
  alignas(64) std::int32_t y_halfway[kRuns];
  // The arrays below are known for steady runs only.
  // Where the segment begins in the first row, in 1/2^14 of a sample; x by part.
  alignas(64) std::int32_t x_from[RunRow::kMaxParts][kRuns];
  alignas(64) std::int32_t y_from[kRuns];
  // The path of the segment's beginning down the band. At the fraction t of the band's height it
  // has moved by t span + t (1 - t) curve + t (1 - t) (1/2 - t) twist: a cubic, since the map is
  // one between its nodes.
  struct SegmentPath {
    alignas(64) float span[kRuns];
    alignas(64) float curve[kRuns];
    alignas(64) float twist[kRuns];
  };
  SegmentPath x_path;
  SegmentPath y_path;
  // RunRow::slope and RunRow::bend in the first row and in the last one.
  alignas(64) std::int32_t slope[2][kRuns];
  alignas(64) std::int32_t bend[2][kRuns];
  // By sample: the distance from the segment's beginning in the first row, without the part of that
  // beginning which is no whole sample or row (the row adds its own), and how much that distance
  // changes until the last row. As RunRow::middle.
  alignas(64) std::int16_t x_shape[kSamples];
  alignas(64) std::int16_t y_shape[kSamples];
  alignas(64) std::int16_t x_change[kSamples];
  alignas(64) std::int16_t y_change[kSamples];
  // What the rows share, by the first run of each vector of runs.
  enum class Kind : std::uint8_t {
    kMixed,      // nothing
    kSteady,     // all of the above, and RunRow::marks
    kHighSlope,  // RunRow::marks: the slope of each run is too high for the bilinear kernel
    kEmpty       // RunRow::marks: the source has nothing to show
  };
  Kind kind[kRuns];
  // RunRow::marks of all runs, where they are all steady and have the same; else 0.
  RunMarks marks;

  // Makes a band whose rows share nothing.
  void clear() noexcept {
    std::fill(std::begin(kind), std::end(kind), Kind::kMixed);
    marks = 0;
  }
};

}  // namespace calvin::remap
