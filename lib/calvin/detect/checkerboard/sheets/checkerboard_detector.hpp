// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector of checkerboards, plain or with a code.
//
// In levels of half the size, the smallest first: peaks of a response to corners, a test of a ring
// of pixels around each, the graph of neighbours whose edges have opposite colours, lattices out of
// the graph; then, where a lattice is one of the boards, a fit of every corner at full resolution.
// One pass serves all boards. The work is bounded for any image, and where the image is no larger
// than those before and shows no more sheets nothing is allocated but what is returned.
#pragma once

#include <memory>
#include <span>

#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

// For boards that has_pattern() knows; the same one may be there several times.
[[nodiscard]] std::unique_ptr<Detector> make_checkerboard_detector(std::span<const Board> boards);

}  // namespace calvin::detect
