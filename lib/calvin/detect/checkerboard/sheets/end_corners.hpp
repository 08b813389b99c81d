// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners of a board at the ends of lines that a hand or the border of the image cuts off.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/fits/refine.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

// Adds to a refined lattice, over which a board lies, the board's corners that have only one other
// corner beside them. While a lattice may be anything such a node tells nothing, and is pruned; of
// a board that is named it is known where it has to be, and how it looks. Adds none in noise.
void add_end_corners(const ImageView& image, const Grid& grid, const GridAlignment& alignment,
                     Refinement& refinement, Lattice& lattice);

}  // namespace calvin::detect
