// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a board lies on its page, or on several. Internal.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// Where the pattern lies on its page; what draw_board() draws, for tests and for renderers.
struct BoardLayout {
  double width = 0;   // of the page, m
  double height = 0;  // m
  double x = 0;       // of control point 0, from the left edge of the page, m
  double y = 0;       // from the top edge, m
};
[[nodiscard]] Result<BoardLayout> lay_out_board(const Board& board, std::string_view paper);

// One of the sheets over which a board is drawn: `page` as of lay_out_board(), and the part of the
// page that is cut out, m from its left and upper edges. Parts of sheets side by side meet in the
// board, as far from control points as may be.
struct BoardTile {
  BoardLayout page;
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;
  int col = 0;
  int row = 0;
  int cols = 1;  // of all sheets
  int rows = 1;
};
// Row by row, on as few sheets of the paper as may be, upright or lying. kInvalidArgument for an
// unknown paper, "fit", and for more than 200 sheets.
[[nodiscard]] Result<std::vector<BoardTile>> lay_out_tiles(const Board& board,
                                                           std::string_view paper);

// m, of the lengths that are compared: for 275 mm that come out as 275.0000001 mm.
inline constexpr double kLengthSlack = 1e-9;

// "a4", "a3", ..., "letter", ...: from small to large.
[[nodiscard]] std::vector<std::string> paper_names();

}  // namespace calvin
