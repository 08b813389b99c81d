// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What control points on a grid answer, whatever the board is.

#include "calvin/target/grid.hpp"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace calvin {

Status Grid::check() const {
  constexpr int kMost = 10000;
  if (cols < 1 || rows < 1 || cols > kMost || rows > kMost || !std::isfinite(pitch) ||
      !(pitch > 0) || !std::isfinite(gap) || !(gap >= 0)) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("A board of {}x{} corners {} m apart does not exist.", cols, rows, pitch));
  }
  return {};
}

std::vector<int> Grid::ids() const {
  std::vector<int> all(static_cast<std::size_t>(count()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<Eigen::Vector3d> Grid::points() const {
  std::vector<Eigen::Vector3d> all;
  all.reserve(static_cast<std::size_t>(count()));
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) all.emplace_back(distance_to(col), distance_to(row), 0);
  }
  return all;
}

std::optional<std::size_t> Grid::index_of(int id) const noexcept {
  if (id < 0 || id >= count()) return std::nullopt;
  return static_cast<std::size_t>(id);
}

std::vector<int> Grid::neighbours(int id) const {
  std::vector<int> all;
  if (!index_of(id)) return all;
  const GridPlace at = place(id);
  for (const GridPlace near : {GridPlace{at.col, at.row - 1}, GridPlace{at.col - 1, at.row},
                               GridPlace{at.col + 1, at.row}, GridPlace{at.col, at.row + 1}}) {
    if (contains(near)) all.push_back(this->id(near));
  }
  return all;
}

}  // namespace calvin
