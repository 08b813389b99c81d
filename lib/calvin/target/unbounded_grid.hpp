// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// UnboundedGrid: dots, or lines that cross, in even columns and rows that go on beyond the picture.
#pragma once

#include <string>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

enum class GridPattern { kDots, kLines };

// Control points are the centres of the dots, or where lines cross. Any part of them may be in view
// and none is the first one: what a picture shows is numbered about the middle of the grid, with
// rows along the x axis of the picture as nearly as may be. That is enough for one camera, since
// every view has a pose of its own; for several cameras, or the shape of the sheet, it is not. What
// the functions answer is said of Board, in target/board.hpp.
struct UnboundedGrid {
  // Columns and rows; a picture with more of them is used in part.
  static constexpr int kSide = 200;
  // The width of a line, of the pitch. Detection does not need it: it is what is printed.
  static constexpr double kLineWidth = 0.15;

  GridPattern pattern = GridPattern::kDots;
  double pitch = 0;       // m, from a control point to the next one
  bool inverted = false;  // light dots or lines on dark ground

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const { return grid().check(); }
  [[nodiscard]] Grid grid() const noexcept { return {kSide, kSide, pitch, 0}; }
  [[nodiscard]] BoardArea outline() const noexcept { return grid().outline(); }
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {{1}, {2}, {3}}; }
  [[nodiscard]] bool looks_like(const UnboundedGrid& other) const noexcept {
    return pattern == other.pattern && inverted == other.inverted;
  }

  friend bool operator==(const UnboundedGrid&, const UnboundedGrid&) = default;
};

class Board;

// Whether views of a board that were taken at one time, or of one sheet, tell which of its points
// are the same: kUnsupported for a grid that goes on beyond the picture.
[[nodiscard]] Status check_names_points(const Board& board);

}  // namespace calvin
