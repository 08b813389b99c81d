// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checkerboard: dark and light squares, whose inner corners are the control points.
#pragma once

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

}  // namespace calvin
