// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The edge of a board: whether margin or more squares lie beyond a line of corners.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

enum class Edge { kNotSeen, kDarkMargin, kBrightMargin };

// Whether beyond a line of nodes (`count` cells from `first` on, some of them missing) there is one
// more row of squares and then the margin, dark or bright: the squares of the other colour end
// together, a square's side beyond the line, and the squares of the margin's colour go on.
// `outwards` is the step of a cell away from the board. kNotSeen where the edge is out of the image
// or covered.
[[nodiscard]] Edge find_edge(const ImageView& image, const Lattice& lattice, Cell first, Cell step,
                             int count, Cell outwards);

// Whether the pattern ends beyond a line of nodes, wherever its last squares were cut off and
// however narrow its margin: the squares of one colour end on a straight line, beyond which those
// of the other colour go on. This tells that no line of nodes follows. It does not tell which line
// of a board this is, for a sheet of paper may cover the next one. False where too little is in
// view.
[[nodiscard]] Edge pattern_ends(const ImageView& image, const Lattice& lattice, Cell first,
                                Cell step, int count, Cell outwards);

// Whether the squares go on beyond a line of nodes that is said to be the outermost one: the edges
// that cross it have exchanged their colours where on a board the margin is. False where too little
// is in view to tell.
[[nodiscard]] bool continues_beyond(const ImageView& image, const Lattice& lattice, Cell first,
                                    Cell step, int count, Cell outwards);

}  // namespace calvin::detect
