// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The checkerboard detector.
//
// In levels of half the size, the smallest first: peaks of a response to corners, a test of a ring
// of pixels around each, the graph of neighbours whose edges have opposite colours, lattices out of
// the graph; then, where a lattice is the board, a fit of every corner at full resolution. The work
// is bounded for any image, and nothing is allocated for an image no larger than those before.
#pragma once

#include <memory>

#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

[[nodiscard]] std::unique_ptr<Detector> make_checkerboard_detector(const Checkerboard& board);

}  // namespace calvin::detect
