// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checkerboard: dark and light squares, whose inner corners are the control points;
// MarkedCheckerboard: one with circles in some of its squares, by which parts of it are known.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

// The square outside control point 0 is dark, which fixes control point 0 wherever cols + rows is
// odd. What the functions answer is said of Board, in target/board.hpp.
struct Checkerboard {
  int cols = 0;     // inner corners along x
  int rows = 0;     // along y
  double size = 0;  // m, side of a square

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const { return grid().check(); }
  [[nodiscard]] Grid grid() const noexcept { return {cols, rows, size}; }
  [[nodiscard]] BoardArea outline() const noexcept { return grid().outline(); }
  [[nodiscard]] std::vector<Relabelling> symmetries() const;
  [[nodiscard]] bool looks_like(const Checkerboard& other) const noexcept;

  [[nodiscard]] Checkerboard with_cells_of(double side) const noexcept {
    return {cols, rows, side};
  }

  friend bool operator==(const Checkerboard&, const Checkerboard&) = default;
};

// A light circle in a dark square, or a dark one in a light square, as the board of DLR's CalDe has
// three of them in its middle, and the radon checkerboards of OpenCV's gen_pattern.py. Squares are
// counted as those of a ChArUco board are: (0, 0) is the one outside of control point 0, and dark.
struct MarkedCheckerboard {
  static constexpr double kCircleDiameter = 0.34;  // of a square's side, as OpenCV prints them
  static constexpr std::size_t kFewestCircles = 3;

  int cols = 0;                    // inner corners along x
  int rows = 0;                    // along y
  double size = 0;                 // m, side of a square
  std::vector<GridPlace> circles;  // squares with a circle, row by row

  // Three squares about the middle: one, the next of its row and the next of its column.
  [[nodiscard]] static std::vector<GridPlace> usual_circles(int cols, int rows);

  [[nodiscard]] bool has_circle(GridPlace square) const noexcept {
    return std::ranges::find(circles, square) != circles.end();
  }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] Grid grid() const noexcept { return {cols, rows, size}; }
  [[nodiscard]] BoardArea outline() const noexcept { return grid().outline(); }
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const MarkedCheckerboard& other) const noexcept {
    return cols == other.cols && rows == other.rows && circles == other.circles;
  }

  [[nodiscard]] MarkedCheckerboard with_cells_of(double side) const {
    return {cols, rows, side, circles};
  }

  friend bool operator==(const MarkedCheckerboard&, const MarkedCheckerboard&) = default;
};

}  // namespace calvin
