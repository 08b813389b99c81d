// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// PuzzleBoard: a checkerboard with a dot on every edge, whose colours name the place.
//
// P. Stelldinger, N. Schönherr and J. Biermann, "PuzzleBoard: A New Camera Calibration Pattern with
// Position Encoding", arXiv 2409.20127. A board is a part of a map of 501 x 501 corners, in which
// any 3x3 squares with the dots on their edges occur once, and any 4x4 in no other turn either.
// Pattern and code are in the public domain (CC0).
#pragma once

#include <string>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

// Control points are the inner corners. What the functions answer is said of Board, in
// target/board.hpp.
struct PuzzleBoard {
  static constexpr int kMapSide = 501;             // corners of the map, which repeats itself
  static constexpr double kDotDiameter = 1.0 / 3;  // of a square's side

  int cols = 0;     // inner corners along x
  int rows = 0;     // along y
  double size = 0;  // m, side of a square
  int x0 = 0;       // of control point 0 in the map
  int y0 = 0;

  // Whether the square outside a control point, up and to the left of it, is dark.
  [[nodiscard]] bool is_dark_before(GridPlace p) const noexcept {
    return (x0 + y0 + p.col + p.row) % 2 == 0;
  }
  // Whether the dot between a control point and the next of its row, or of its column, is light.
  // Also for places beyond the board, on which the map goes on.
  [[nodiscard]] bool is_light_after(GridPlace p) const noexcept;
  [[nodiscard]] bool is_light_below(GridPlace p) const noexcept;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] Grid grid() const noexcept { return {cols, rows, size}; }
  [[nodiscard]] BoardArea outline() const noexcept { return grid().outline(); }
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const PuzzleBoard& other) const noexcept;

  [[nodiscard]] PuzzleBoard with_cells_of(double side) const noexcept {
    return {cols, rows, side, x0, y0};
  }

  friend bool operator==(const PuzzleBoard&, const PuzzleBoard&) = default;
};

}  // namespace calvin
