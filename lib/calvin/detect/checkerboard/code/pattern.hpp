// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pattern: a board whose control points are corners of squares, as the search for it needs it.
#pragma once

#include <memory>

#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/surroundings.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/checkerboard.hpp"
#include "calvin/target/grid.hpp"

namespace calvin::detect {

struct Pattern {
  // For boards with corners of squares, which has_pattern() tells.
  explicit Pattern(Board of);

  Board board;
  Grid grid;
  Surroundings surroundings;
  // Null for a plain checkerboard, whose corners are named by its edges alone.
  std::shared_ptr<const Code> code;
  int code_corners = 0;  // corners that squares of the code make, about, for each of the board

  [[nodiscard]] Checkerboard squares() const { return {grid.cols, grid.rows, grid.pitch}; }
};

[[nodiscard]] bool has_pattern(const Board& board);

}  // namespace calvin::detect
