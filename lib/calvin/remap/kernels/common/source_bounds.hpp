// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which parts of a source plane the vector kernels may read.
#pragma once

#include <cstdint>

namespace calvin::remap {

// The source plane as the bilinear and the bicubic kernels see it: which coordinates are inside,
// and which slopes a segment can hold. Columns and rows are counted in samples from 0.
struct SourceBounds {
  std::int32_t stride = 0;        // bytes
  std::int32_t first_column = 0;  // the first sample that shows nothing but the frame
  std::int32_t first_row = 0;
  // The last coordinate is in 0..last: its right or lower neighbour is there. last_row = -1: there
  // is no kernel for the plane.
  std::int32_t last_column = 0;
  std::int32_t last_row = 0;
  std::int32_t max_columns = 0;  // columns that a segment holds, less one
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  std::int32_t guarded_rows = 1;    // rows at the bottom whose end must not be read past
  std::int32_t last_segment = 0;    // bytes; in those rows a segment must begin before this byte
  std::int32_t max_slope = 0x7FFF;  // the largest slope along a row, 2.14
  bool strongly_bent = false;       // third differences of the middles count (kThirdPart)
  bool fills = false;               // outside of the source is the fill
};

// The source samples along one axis as the gather kernel sees them. Coordinates are in samples.
struct AxisEnds {
  int count = 0;
  float low = 0;  // the source shows something from `low` to `high`
  float high = 0;
  float first = 0;      // what lies before this coordinate is replicated from here
  int last = 0;         // the last sample that lies where its number says
  bool uneven = false;  // one more sample lies behind it, at less than the usual distance
};

}  // namespace calvin::remap
