// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a checkerboard answers, and which circles tell its corners.

#include "calvin/target/checkerboard.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"

namespace calvin {

namespace {

void sort_by_row(std::vector<GridPlace>& places) {
  std::ranges::sort(places, {}, [](GridPlace p) { return std::pair(p.row, p.col); });
}

// Whether the circles would look the same after so many quarter turns and some shift: squares keep
// their colours then.
bool look_the_same(const std::vector<GridPlace>& circles, int quarters) {
  std::vector<GridPlace> turned = circles;
  for (int i = 0; i < quarters; ++i) {
    for (GridPlace& p : turned) p = {-p.row, p.col};
  }
  sort_by_row(turned);
  const int right = circles.front().col - turned.front().col;
  const int down = circles.front().row - turned.front().row;
  // A shift by an odd number of squares exchanges their colours.
  const bool is_same_colour = (right + down) % 2 == 0;
  return is_same_colour && std::ranges::equal(circles, turned, [&](GridPlace a, GridPlace b) {
           return a == GridPlace{b.col + right, b.row + down};
         });
}

}  // namespace

std::string Checkerboard::text() const {
  return fmt::format("checkerboard:{}x{}:{}", cols, rows, length_text(size));
}

std::vector<Relabelling> Checkerboard::symmetries() const {
  if ((cols + rows) % 2 != 0) return {};
  if (cols == rows && cols % 2 == 0) return {{1}, {2}, {3}};
  return {{2}};
}

bool Checkerboard::looks_like(const Checkerboard& other) const noexcept {
  return std::minmax(cols, rows) == std::minmax(other.cols, other.rows);
}

std::vector<GridPlace> MarkedCheckerboard::usual_circles(int cols, int rows) {
  const GridPlace corner{cols / 2, rows / 2};
  return {corner, {corner.col + 1, corner.row}, {corner.col, corner.row + 1}};
}

std::string MarkedCheckerboard::text() const {
  std::string all = Checkerboard{cols, rows, size}.text() + ":circles";
  if (circles == usual_circles(cols, rows)) return all;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    all += fmt::format("{}{}.{}", i == 0 ? "=" : "+", circles[i].col, circles[i].row);
  }
  return all;
}

Status MarkedCheckerboard::check() const {
  const auto refuse = [&](std::string why) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The board {} does not exist: {}.", text(), why));
  };
  if (const Status status = grid().check(); !status) return status;
  if (circles.size() < kFewestCircles) {
    return refuse(
        fmt::format("it has {} circles, at least {} are needed", circles.size(), kFewestCircles));
  }
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const GridPlace p = circles[i];
    if (p.col < 1 || p.row < 1 || p.col >= cols || p.row >= rows) {
      return refuse(fmt::format("the square at column {}, row {} is not between four inner corners",
                                p.col, p.row));
    }
    const bool is_in_order =
        i == 0 || std::pair(circles[i - 1].row, circles[i - 1].col) < std::pair(p.row, p.col);
    if (!is_in_order) return refuse("a circle is named twice, or before one that is above it");
  }
  // Of fewer squares with and without circles too many arrangements would be one by chance.
  constexpr int kFewestSquares = 20;
  if (const int squares = (cols - 1) * (rows - 1); squares < kFewestSquares) {
    return refuse(fmt::format(
        "it has {} squares between its inner corners, at least {} are needed for circles to name "
        "corners",
        squares, kFewestSquares));
  }
  for (const int quarters : {1, 2, 3}) {
    if (look_the_same(circles, quarters)) {
      return refuse("its circles look the same when the board is turned");
    }
  }
  return {};
}

}  // namespace calvin
