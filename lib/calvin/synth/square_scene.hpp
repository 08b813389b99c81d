// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A checkerboard as a scene: the polygon that a pixel covers is cut at the edges of the squares.
// Internal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "calvin/synth/pixel_polygon.hpp"
#include "calvin/synth/scene_levels.hpp"
#include "calvin/target/checkerboard.hpp"

namespace calvin::synth {

// What a ray meets: square (col, row) of the board plane, counted from control point 0; -1 is the
// first square of the pattern, -2 the margin, kOutside and count + 1 all that lies beyond.
struct Square {
  int col;
  int row;
  friend bool operator==(const Square&, const Square&) = default;
};
constexpr int kOutside = -3;
constexpr int kNothing = -4;  // the ray does not meet the board plane

class SquareScene {
 public:
  using Place = Square;

  SquareScene(const Checkerboard& board, const SceneLevels& levels)
      : cols_(board.cols), rows_(board.rows), size_(board.size), levels_(levels) {}

  [[nodiscard]] double unit() const { return size_; }
  [[nodiscard]] static Square nothing() { return {kNothing, kNothing}; }
  [[nodiscard]] Square place_at(double x, double y) const {
    return {index(x, cols_), index(y, rows_)};
  }

  // `corners` returns the PixelCorners of the pixel that sees these squares.
  template <typename Corners>
  [[nodiscard]] double mean(const Corners& corners, const std::array<Square, 4>& seen) const {
    if (seen[0] == seen[1] && seen[0] == seen[2] && seen[0] == seen[3]) return value(seen[0]);
    Polygon pixel;
    for (const Vertex& corner : corners()) pixel.push(corner);
    return mean(pixel, seen);
  }

 private:
  static constexpr double kFar = 1e30;

  static int index(double x, int count) {
    return static_cast<int>(std::floor(std::clamp(x, -2.5, count + 1.5)));
  }

  [[nodiscard]] double value(Square s) const {
    if (s.col <= kOutside || s.row <= kOutside || s.col > cols_ || s.row > rows_) {
      return levels_.background;
    }
    if (s.col < -1 || s.row < -1 || s.col == cols_ || s.row == rows_) return levels_.light;
    return (s.col + s.row) % 2 == 0 ? levels_.dark : levels_.light;
  }

  // The mean over a pixel whose corners see the squares `seen`.
  [[nodiscard]] double mean(const Polygon& pixel, const std::array<Square, 4>& seen) const {
    const auto [left, right] = std::minmax({seen[0].col, seen[1].col, seen[2].col, seen[3].col});
    const auto [top, bottom] = std::minmax({seen[0].row, seen[1].row, seen[2].row, seen[3].row});
    if (left == kNothing || left > cols_ || top > rows_ || right == kOutside ||
        bottom == kOutside) {
      return levels_.background;
    }
    double sum = 0;
    Polygon rest = pixel, column, next;
    for (int col = left; col <= right; ++col) {
      cut(rest, &Vertex::x, col < right ? col + 1 : kFar, column, next);
      rest = next;
      Polygon piece;
      for (int row = top; row <= bottom; ++row) {
        cut(column, &Vertex::y, row < bottom ? row + 1 : kFar, piece, next);
        column = next;
        sum += piece.area() * value({col, row});
      }
    }
    return sum;
  }

  int cols_;
  int rows_;
  double size_;
  SceneLevels levels_;
};

}  // namespace calvin::synth
