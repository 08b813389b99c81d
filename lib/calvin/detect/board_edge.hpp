// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a board ends.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/lattice.hpp"

namespace calvin::detect {

enum class Edge { kNotSeen, kDarkMargin, kBrightMargin };

// Whether beyond a line of nodes (`count` cells from `first` on, some of them missing) there is one
// more row of squares and then the margin, dark or bright: those squares that differ from it end
// together, a square's side beyond the line, and the others go on. `outwards` is a cell's step.
// Not seen too where it is out of the image, or covered.
[[nodiscard]] Edge look_for_edge(const ImageView& image, const Lattice& lattice, Cell first,
                                 Cell step, int count, Cell outwards);

// Whether the squares go on beyond a line of nodes that is said to be the outermost one: the edges
// that cross it have exchanged their colours where on a board the margin is. False where too little
// is in view to tell.
[[nodiscard]] bool goes_on(const ImageView& image, const Lattice& lattice, Cell first, Cell step,
                           int count, Cell outwards);

}  // namespace calvin::detect
