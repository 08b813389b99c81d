// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the bits of a marker are read that is expected in a square between four corners.
#pragma once

#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// A marker in the middle of a square, in parts of the square's side.
struct MarkerShape {
  int side = 0;           // bits
  float cell = 0;         // side of a bit
  float rim = 0;          // side of the square along which the rim is looked at
  float around = 0;       // side of the square along which what is around the marker is looked at
  bool inverted = false;  // the rim is light
};

// That of a ChArUco board whose markers have so large a share of a square's side.
[[nodiscard]] MarkerShape marker_shape(float share, int side, bool inverted);

// Whether all four corners of the square are there whose upper left corner is the node of `at`.
[[nodiscard]] bool is_whole_square(const Lattice& lattice, Cell at);

// Reads the bits of the marker in the square whose upper left corner is the node of cell `at`, in
// rows, where it may hold one. Appends to `bits`.
void read_marker(const ImageView& image, const Lattice& lattice, Cell at, const MarkerShape& shape,
                 std::vector<CodeBit>& bits);

// Appends the mean grey levels of the cells of such a marker to `greys`, in rows, whatever they
// look like; in units of the contrast of the square's corners. False, and nothing appended, where
// not all of them are in the image.
[[nodiscard]] bool read_greys(const ImageView& image, const Lattice& lattice, Cell at,
                              const MarkerShape& shape, std::vector<float>& greys);

// The share of the square's side that its marker has, rim and all: `shape` tells about where the
// rim is. Absent where it has none.
[[nodiscard]] std::optional<float> measure_marker(const ImageView& image, const Lattice& lattice,
                                                  Cell at, const MarkerShape& shape);

// Reads whether there is a circle in the middle of the square, of the colour of the squares beside
// it: one bit, light where there is. Appends to `bits`.
void read_circle(const ImageView& image, const Lattice& lattice, Cell at,
                 std::vector<CodeBit>& bits);

// Code::turned() for such bits.
[[nodiscard]] CodePlace turned_in_marker(const CodePlace& at, int side, int quarter);

}  // namespace calvin::detect
