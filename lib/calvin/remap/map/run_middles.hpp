// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The source coordinates of the middles of runs at one row of the map's nodes.
#pragma once

#include <array>
#include <cstdint>

namespace calvin::remap {

// Where the middles of runs lie between the columns of the map's nodes: by run the first of the
// four columns to interpolate from, and the cubic weights of the first, the third and the fourth
// (the second has what is left of 1).
struct RunColumns {
  const std::int32_t* column;
  std::array<const float*, 3> weights;
};

// One coordinate of a row of nodes. The source coordinate in 1/2^14 of a sample is
// scale * node - offset.
struct NodeLine {
  const float* nodes;
  int count;
  float scale;
  float offset;
};

// Writes the source coordinates of `count` runs from the run `first` on, in 1/2^14 of a sample.
void expand_runs(const RunColumns& runs, int first, int count, const NodeLine& line,
                 float* to) noexcept;

}  // namespace calvin::remap
