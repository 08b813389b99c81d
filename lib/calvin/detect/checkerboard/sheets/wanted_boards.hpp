// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The boards that are looked for in one pass, and what a search for all of them takes.
#pragma once

#include <vector>

#include "calvin/detect/checkerboard/board_search.hpp"
#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin::detect {

// A board, and how many sheets of it are expected to be in view.
struct WantedBoard {
  Pattern pattern;
  int sheets = 1;
};

// What may lie around the corners of any of them.
[[nodiscard]] Surroundings surroundings_of(const std::vector<WantedBoard>& wanted);

// Corners of the largest one.
[[nodiscard]] int most_points(const std::vector<WantedBoard>& wanted);

// How corners are searched for in a level of the pyramid.
[[nodiscard]] SearchOptions search_options(const std::vector<WantedBoard>& wanted,
                                           const Pyramid& pyramid, int level);

}  // namespace calvin::detect
