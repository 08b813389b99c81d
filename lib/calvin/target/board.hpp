// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Board: a physical target, its control points and the text that names it.
//
// Board frame: origin at control point 0, x along a row, y down the columns, z into the board
// (away from a camera that looks at its face). Control point (col, row) has the id
// row * cols + col. On a checkerboard the square outside control point 0 is dark, which fixes
// control point 0 wherever cols + rows is odd.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"

namespace calvin {

inline constexpr std::string_view kDefaultBoard = "checkerboard:9x6:25mm";

enum class BoardKind { kCheckerboard };

struct Board {
  BoardKind kind = BoardKind::kCheckerboard;
  int cols = 0;     // control points along x; inner corners for a checkerboard
  int rows = 0;     // along y
  double size = 0;  // m, side of a square

  // The canonical text, e.g. "checkerboard:9x6:25mm".
  [[nodiscard]] std::string text() const;

  // All control points in the board frame, m, in the order of their ids.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  [[nodiscard]] int point_count() const noexcept { return cols * rows; }

  // The turns about z after which the board looks the same: "rotate180", for square boards also
  // "rotate90" and "rotate270"; empty where the board tells its own orientation.
  [[nodiscard]] std::vector<std::string> symmetries() const;
};

// One board text, e.g. "checkerboard:9x6:25mm"; an error shows a right one.
[[nodiscard]] Result<Board> parse_board(std::string_view text);

// A length with its unit: "25mm", "2.5cm", "0.025m", "1in" -> m.
[[nodiscard]] Result<double> parse_length(std::string_view text);

}  // namespace calvin
