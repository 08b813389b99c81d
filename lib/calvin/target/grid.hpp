// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grid: the columns and rows of control points, the only place where ids are counted in rows.
// BoardArea: a rectangle in the plane of a board.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/export.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

struct GridPlace {
  int col = 0;
  int row = 0;

  friend bool operator==(const GridPlace&, const GridPlace&) = default;
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

// Control points in columns along x and rows along y of the board frame. The id of a point is
// row * cols + col.
struct Grid {
  int cols = 0;
  int rows = 0;
  double pitch = 0;  // m, from one control point to the next, along x and along y
  // m, the same from every second column and row to the next, which is closer; 0 where all are a
  // pitch apart.
  double gap = 0;

  // m, from column 0 to another one, or from row 0; those may lie beyond the grid.
  [[nodiscard]] double distance_to(int line) const noexcept {
    if (gap == 0) return line * pitch;
    const int pairs = (line < 0 ? line - 1 : line) / 2;
    return pairs * (pitch + gap) + (line - 2 * pairs) * pitch;
  }
  // m, from a line to the next, at least and on average.
  [[nodiscard]] double least_step() const noexcept { return gap == 0 || gap > pitch ? pitch : gap; }
  [[nodiscard]] double mean_step() const noexcept { return gap == 0 ? pitch : (pitch + gap) / 2; }
  // The shorter step in parts of it.
  [[nodiscard]] double gap_share() const noexcept { return least_step() / mean_step(); }

  [[nodiscard]] int count() const noexcept { return cols * rows; }
  [[nodiscard]] bool contains(GridPlace p) const noexcept {
    return p.col >= 0 && p.row >= 0 && p.col < cols && p.row < rows;
  }
  // For places and ids on the grid only.
  [[nodiscard]] int id(GridPlace p) const noexcept { return p.row * cols + p.col; }
  [[nodiscard]] GridPlace place(int id) const noexcept { return {id % cols, id / cols}; }

  // kInvalidArgument for measures that no board has.
  [[nodiscard]] CALVIN_API Status check() const;

  // What the functions answer is said of Board, in target/board.hpp.
  [[nodiscard]] CALVIN_API std::vector<int> ids() const;
  [[nodiscard]] CALVIN_API std::vector<Eigen::Vector3d> points() const;
  [[nodiscard]] CALVIN_API std::optional<std::size_t> index_of(int id) const noexcept;
  [[nodiscard]] CALVIN_API std::vector<int> neighbours(int id) const;
  [[nodiscard]] double cell_size(int /*id*/) const noexcept { return pitch; }
  [[nodiscard]] BoardArea extent() const noexcept {
    return {0, 0, distance_to(cols - 1), distance_to(rows - 1)};
  }
  // Around whole cells outside of the outermost control points.
  [[nodiscard]] BoardArea outline() const noexcept {
    return {distance_to(-1), distance_to(-1), distance_to(cols), distance_to(rows)};
  }

  friend bool operator==(const Grid&, const Grid&) = default;
};

}  // namespace calvin
