// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector of boards of discs.
//
// In levels of half the size, the smallest first: pixels darker than a ring around them, the
// ellipse around each, lattices that grow from one to the next; then, where a lattice is one of the
// boards, a fit of every disc at full resolution.
#pragma once

#include <memory>
#include <span>

#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

// For boards that has_circle_pattern() knows; the same one may be there several times.
[[nodiscard]] std::unique_ptr<Detector> make_circle_detector(std::span<const Board> boards);

}  // namespace calvin::detect
