// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace calvin::detect {

namespace {

Pixel operator+(Pixel a, Pixel b) { return {a.u + b.u, a.v + b.v}; }
Pixel operator-(Pixel a, Pixel b) { return {a.u - b.u, a.v - b.v}; }
Pixel operator*(double s, Pixel a) { return {s * a.u, s * a.v}; }
double length(Pixel a) { return std::hypot(a.u, a.v); }
double cross(Pixel a, Pixel b) { return a.u * b.v - a.v * b.u; }

// The mean of 3 x 3 pixels around a point; absent where they are not all in the image.
std::optional<double> grey(const ImageView& image, Pixel at) {
  if (!(at.u >= 1 && at.v >= 1 && at.u < image.width - 2 && at.v < image.height - 2)) {
    return std::nullopt;
  }
  const int u = static_cast<int>(std::lround(at.u));
  const int v = static_cast<int>(std::lround(at.v));
  int sum = 0;
  for (int y = v - 1; y <= v + 1; ++y) {
    for (int x = u - 1; x <= u + 1; ++x) sum += image.at(x, y);
  }
  return sum / 9.0;
}

// How much darker the squares inside and outside of a corner (by the axes' directions) are than
// the other two; twice the contrast between the squares at a corner of the board, about once at a
// point of its outer edge. `share`: how far into the squares to look, 0.5 for their middle.
std::optional<double> saddle(const ImageView& image, Pixel at, const Axes& axes,
                             double share = 0.5) {
  const Pixel a = share * (axes.along + axes.down);
  const Pixel b = share * (axes.along - axes.down);
  const auto inside = grey(image, at + a);
  const auto outside = grey(image, at - a);
  const auto right = grey(image, at + b);
  const auto left = grey(image, at - b);
  if (!inside || !outside || !right || !left) return std::nullopt;
  return *right + *left - *inside - *outside;
}

// The saddles of all corners, those of odd corners negated: all of one sign on a checkerboard.
// Corners at the border of the image may have none (0).
std::vector<double> saddles(const ImageView& image, const Grid& grid) {
  std::vector<double> all;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const double s = saddle(image, grid.at(col, row), axes_at(grid, col, row)).value_or(0);
      all.push_back((row + col) % 2 == 0 ? s : -s);
    }
  }
  return all;
}

// The sign that all saddles share, or 0.
int common_sign(const std::vector<double>& all) {
  double sum = 0;
  for (const double s : all) sum += s / static_cast<double>(all.size());
  for (const double s : all) {
    if (s != 0 && !(s * sum > 0.1 * sum * sum)) return 0;
  }
  return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

// A row of corners goes on beyond the first row of `grid`.
bool goes_on(const ImageView& image, const Grid& grid) {
  int seen = 0;
  int corners = 0;
  for (int col = 0; col < grid.cols; ++col) {
    // By a parabola through the first three corners of the column.
    const Pixel beyond = 3.0 * grid.at(col, 0) - 3.0 * grid.at(col, 1) + grid.at(col, 2);
    Axes axes = axes_at(grid, col, 0);
    const auto inner = saddle(image, grid.at(col, 0), axes);
    axes.down = grid.at(col, 0) - beyond;
    const auto outer = saddle(image, beyond, axes);
    if (!inner || !outer) continue;
    ++seen;
    if (-*outer * *inner > 0.75 * *inner * *inner) ++corners;
  }
  return corners >= 2 && 5 * corners > 3 * seen;
}

Grid turn90(const Grid& grid) {
  Grid turned = {grid.rows, grid.cols, {}};
  for (int row = 0; row < turned.rows; ++row) {
    for (int col = 0; col < turned.cols; ++col) {
      turned.points.push_back(grid.at(grid.cols - 1 - row, col));
    }
  }
  return turned;
}

Grid mirror(const Grid& grid) {
  Grid mirrored = grid;
  for (int row = 0; row < grid.rows; ++row) {
    std::reverse(mirrored.points.begin() + row * grid.cols,
                 mirrored.points.begin() + (row + 1) * grid.cols);
  }
  return mirrored;
}

// How far a corner lies from where the next three of its line expect it, to second order.
double misfit(const Grid& grid, int col, int row, int dcol, int drow) {
  const auto at = [&](int i) { return grid.at(col + i * dcol, row + i * drow); };
  return length(at(0) - 3.0 * at(1) + 3.0 * at(2) - at(3));
}

bool lies_well(const Grid& grid, int col, int row) {
  constexpr double kShare = 0.1;  // of the distance between corners
  const int dcol = 2 * col < grid.cols ? 1 : -1;
  const int drow = 2 * row < grid.rows ? 1 : -1;
  const Axes axes = axes_at(grid, col, row);
  return (grid.cols < 6 || misfit(grid, col, row, dcol, 0) < kShare * length(axes.along)) &&
         (grid.rows < 6 || misfit(grid, col, row, 0, drow) < kShare * length(axes.down));
}

}  // namespace

Axes axes_at(const Grid& grid, int col, int row) {
  const int left = std::max(col - 1, 0);
  const int right = std::min(col + 1, grid.cols - 1);
  const int top = std::max(row - 1, 0);
  const int bottom = std::min(row + 1, grid.rows - 1);
  return {(1.0 / (right - left)) * (grid.at(right, row) - grid.at(left, row)),
          (1.0 / (bottom - top)) * (grid.at(col, bottom) - grid.at(col, top))};
}

double spacing_at(const Grid& grid, int col, int row) {
  const Axes axes = axes_at(grid, col, row);
  const double area = std::abs(cross(axes.along, axes.down));
  // The steps away from the corner on either side; beyond the border of the grid, where a further
  // square lies, they shrink on as they did before.
  const auto least_step = [&](int at, int count, int dcol, int drow) {
    const auto step = [&](int from) {
      const int c = dcol * from + (1 - dcol) * col;
      const int r = drow * from + (1 - drow) * row;
      return length(grid.at(c + dcol, r + drow) - grid.at(c, r));
    };
    const auto beyond = [](double last, double before) {
      return std::clamp(2 * last - before, 0.5 * last, last);
    };
    if (at == 0) return std::min(step(0), beyond(step(0), step(1)));
    if (at == count - 1) return std::min(step(at - 1), beyond(step(at - 1), step(at - 2)));
    return std::min(step(at - 1), step(at));
  };
  const double along = length(axes.along);
  const double down = length(axes.down);
  if (!(along > 0) || !(down > 0)) return 0;
  const double sine = area / (along * down);
  return sine * std::min(least_step(col, grid.cols, 1, 0), least_step(row, grid.rows, 0, 1));
}

double least_spacing(const Grid& grid) {
  double least = std::numeric_limits<double>::infinity();
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      least = std::min(least, spacing_at(grid, col, row));
    }
  }
  return least;
}

bool is_smooth(const Grid& grid) {
  constexpr double kBend = 0.5;  // of the distance between neighbours
  constexpr double kShear = 0.4;
  const auto fits = [](Pixel error, Pixel step, double share) {
    return length(error) <= share * length(step);
  };
  int turn = 0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const Pixel p = grid.at(col, row);
      const Axes axes = axes_at(grid, col, row);
      if (col > 0 && col + 1 < grid.cols &&
          !fits(grid.at(col - 1, row) + grid.at(col + 1, row) - 2.0 * p, axes.along, kBend)) {
        return false;
      }
      if (row > 0 && row + 1 < grid.rows &&
          !fits(grid.at(col, row - 1) + grid.at(col, row + 1) - 2.0 * p, axes.down, kBend)) {
        return false;
      }
      if (col + 1 == grid.cols || row + 1 == grid.rows) continue;
      const Pixel right = grid.at(col + 1, row) - p;
      const Pixel down = grid.at(col, row + 1) - p;
      if (!fits(grid.at(col + 1, row + 1) - p - right - down, right + down, kShear)) return false;
      // All cells turn the same way.
      const int sign = cross(right, down) > 0 ? 1 : -1;
      if (turn != 0 && sign != turn) return false;
      turn = sign;
    }
  }
  return true;
}

bool has_corners(const ImageView& image, const Grid& grid) {
  constexpr double kNear = 3;  // px
  struct Corner {
    int col;
    int row;
    double ratio;  // of the contrast near the corner to that of the squares
  };
  std::vector<Corner> corners;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const Axes axes = axes_at(grid, col, row);
      const double side = std::min(length(axes.along), length(axes.down));
      const double share = std::clamp(kNear / side, 0.1, 0.25);
      const auto wide = saddle(image, grid.at(col, row), axes);
      const auto narrow = saddle(image, grid.at(col, row), axes, share);
      if (wide && narrow) corners.push_back({col, row, *narrow / *wide});
    }
  }
  if (corners.empty()) return true;
  const auto middle = corners.begin() + static_cast<std::ptrdiff_t>(corners.size() / 2);
  std::nth_element(corners.begin(), middle, corners.end(),
                   [](const Corner& a, const Corner& b) { return a.ratio < b.ratio; });
  const double usual = middle->ratio;
  // A weak one may be damaged print, if it lies well; or it is no corner.
  return std::all_of(corners.begin(), corners.end(), [&](const Corner& c) {
    return c.ratio > 0.6 * usual || (c.ratio > 0.2 * usual && lies_well(grid, c.col, c.row));
  });
}

Reason label(const ImageView& image, const Board& board, Grid& grid,
             std::vector<std::string>& ambiguous) {
  const Axes axes = axes_at(grid, 0, 0);
  if (cross(axes.along, axes.down) < 0) grid = mirror(grid);
  if (common_sign(saddles(image, grid)) == 0) return Reason::kNotFound;

  std::optional<Grid> best;
  int equal = 0;
  for (int turn = 0; turn < 4; ++turn, grid = turn90(grid)) {
    if (goes_on(image, grid)) return Reason::kWrongBoard;
    if (grid.cols != board.cols || grid.rows != board.rows) continue;
    if (common_sign(saddles(image, grid)) < 0) continue;  // the square outside corner 0 is light
    ++equal;
    if (!best || length(grid.points[0]) < length(best->points[0])) best = grid;
  }
  if (!best) return Reason::kWrongBoard;
  grid = *best;
  if (equal > 1) ambiguous = board.symmetries();
  return Reason::kAccepted;
}

}  // namespace calvin::detect
