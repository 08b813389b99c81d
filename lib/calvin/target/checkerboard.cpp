// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a checkerboard answers.

#include "calvin/target/checkerboard.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace calvin {

std::string Checkerboard::text() const {
  return fmt::format("checkerboard:{}x{}:{}mm", cols, rows, std::round(size * 1e9) / 1e6);
}

Status Checkerboard::check() const {
  if (cols < 1 || rows < 1 || cols > 10000 || rows > 10000 || !std::isfinite(size) || !(size > 0)) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("A board of {}x{} corners {} m apart does not exist.", cols, rows, size));
  }
  return {};
}

std::vector<int> Checkerboard::ids() const {
  std::vector<int> all(static_cast<std::size_t>(point_count()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<Eigen::Vector3d> Checkerboard::points() const {
  std::vector<Eigen::Vector3d> all;
  all.reserve(static_cast<std::size_t>(point_count()));
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) all.emplace_back(col * size, row * size, 0);
  }
  return all;
}

std::optional<std::size_t> Checkerboard::index_of(int id) const noexcept {
  if (id < 0 || id >= point_count()) return std::nullopt;
  return static_cast<std::size_t>(id);
}

std::vector<int> Checkerboard::neighbours(int id) const {
  std::vector<int> all;
  if (!index_of(id)) return all;
  const Grid grid = *this->grid();
  const GridPlace at = grid.place(id);
  for (const GridPlace near : {GridPlace{at.col, at.row - 1}, GridPlace{at.col - 1, at.row},
                               GridPlace{at.col + 1, at.row}, GridPlace{at.col, at.row + 1}}) {
    if (grid.contains(near)) all.push_back(grid.id(near));
  }
  return all;
}

BoardArea Checkerboard::extent() const noexcept {
  return {0, 0, (cols - 1) * size, (rows - 1) * size};
}

BoardArea Checkerboard::outline() const noexcept {
  return {-size, -size, cols * size, rows * size};
}

std::vector<Relabelling> Checkerboard::symmetries() const {
  if ((cols + rows) % 2 != 0) return {};
  if (cols == rows && cols % 2 == 0) return {{1}, {2}, {3}};
  return {{2}};
}

bool Checkerboard::looks_like(const Checkerboard& other) const noexcept {
  return std::minmax(cols, rows) == std::minmax(other.cols, other.rows);
}

}  // namespace calvin
