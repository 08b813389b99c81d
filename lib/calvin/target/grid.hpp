// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grid: the columns and rows of control points, the only place where ids are counted in rows.
// BoardArea: a rectangle in the plane of a board.
#pragma once

namespace calvin {

struct GridPlace {
  int col = 0;
  int row = 0;

  friend bool operator==(const GridPlace&, const GridPlace&) = default;
};

// Control points in columns along x and rows along y of the board frame. The id of a point is
// row * cols + col.
struct Grid {
  int cols = 0;
  int rows = 0;
  double pitch = 0;  // m, from one control point to the next, along x and along y

  [[nodiscard]] int count() const noexcept { return cols * rows; }
  [[nodiscard]] bool contains(GridPlace p) const noexcept {
    return p.col >= 0 && p.row >= 0 && p.col < cols && p.row < rows;
  }
  // For places and ids on the grid only.
  [[nodiscard]] int id(GridPlace p) const noexcept { return p.row * cols + p.col; }
  [[nodiscard]] GridPlace place(int id) const noexcept { return {id % cols, id / cols}; }

  friend bool operator==(const Grid&, const Grid&) = default;
};

// m, in the board frame, with sides along x and y.
struct BoardArea {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;

  [[nodiscard]] double width() const noexcept { return right - left; }
  [[nodiscard]] double height() const noexcept { return bottom - top; }
};

}  // namespace calvin
