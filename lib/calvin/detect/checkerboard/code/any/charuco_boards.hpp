// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The ChArUco board that nobody asked for: which one it is by the ids of its markers.
#pragma once

#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/target/charuco_board.hpp"

namespace calvin::detect {

// Of any dictionary, order, colours and share of the markers; squares have sides of `square` m, and
// the markers as much of that as they are seen to have. Of the dictionaries that begin with the
// same markers it is the smallest. `whole` where no line of corners can follow on any side of the
// lattice; else the board has as many columns as the ids say, and as many rows as are seen. Absent
// where markers are too few or contradict each other.
[[nodiscard]] std::optional<CharucoBoard> find_charuco_board(const ImageView& image,
                                                             const Lattice& lattice, bool whole,
                                                             double square);

}  // namespace calvin::detect
