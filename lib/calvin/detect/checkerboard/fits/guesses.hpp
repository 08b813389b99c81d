// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether there are corners where the neighbours of a cell let one be expected.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// Removes the guessed nodes of a lattice that are no corners of the image; moves the others to
// where they are, and they are guessed no more.
void confirm_guesses(const ImageView& image, Lattice& lattice);

// Whether there is a corner where a node lies that is only expected, by a fit that knows its edges;
// moves the node there.
[[nodiscard]] bool confirm_guess(const ImageView& image, const Lattice& lattice, Cell c,
                                 Node& node);

}  // namespace calvin::detect
