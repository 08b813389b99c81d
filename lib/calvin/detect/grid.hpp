// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Found corners as a grid: is it the board, and which corner is which.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

// Corners in rows and columns, px.
struct Grid {
  int cols = 0;
  int rows = 0;
  std::vector<Pixel> points;  // row by row

  [[nodiscard]] const Pixel& at(int col, int row) const {
    return points[static_cast<std::size_t>(row * cols + col)];
  }
};

// From a corner to the next along the rows and down the columns, px.
struct Axes {
  Pixel along;
  Pixel down;
};
[[nodiscard]] Axes axes_at(const Grid& grid, int col, int row);

// The least distance from a corner to the grid lines around it, px. At least 3 x 3 corners.
[[nodiscard]] double spacing_at(const Grid& grid, int col, int row);
[[nodiscard]] double least_spacing(const Grid& grid);

// Every corner lies where its neighbours let it expect.
[[nodiscard]] bool is_smooth(const Grid& grid);

// The four squares meet at each corner of the grid: near it the colours are those of their middles.
[[nodiscard]] bool has_corners(const ImageView& image, const Grid& grid);

// Turns the grid so that control point 0 comes first, by the colours of the squares in `image`.
// kAccepted, or why the grid is not the board: a corner without the colours of a checkerboard
// (kNotFound), a further row of corners or exchanged colours (kWrongBoard). `ambiguous` gets the
// labellings that are left.
[[nodiscard]] Reason label(const ImageView& image, const Board& board, Grid& grid,
                           std::vector<std::string>& ambiguous);

}  // namespace calvin::detect
