// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/refine.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace calvin::detect {

namespace {

constexpr int kLeastWindow = 2;  // px, half of the side
constexpr int kLargestWindow = 12;
constexpr double kWindowShare = 0.5;  // of the distance between grid lines

int window_at(const Grid& grid, int col, int row) {
  return std::clamp(static_cast<int>(kWindowShare * spacing_at(grid, col, row)), kLeastWindow,
                    kLargestWindow);
}

// The mean of s^2 along a line through the window's centre, weighted as cv::cornerSubPix does:
// exp(-s^2 / window^2) inside a square.
double mean_square(Pixel direction, int window) {
  constexpr int kSteps = 32;
  const double end = (window + 0.5) / std::max(std::abs(direction.u), std::abs(direction.v));
  double sum = 0;
  double weights = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) * end / kSteps;
    const double weight = std::exp(-s * s / (window * window));
    weights += weight;
    sum += weight * s * s;
  }
  return sum / weights;
}

// A line of the grid near a corner: its normal, and by how much cv::cornerSubPix leaves it.
struct Bend {
  Pixel normal;
  double offset;  // px along the normal, to be added
};

// From three corners in a line, of which the middle one is the corner in question or next to it.
// cornerSubPix takes edges for straight. At an edge s -> (s, k s^2 / 2) its condition, gradients
// perpendicular to the way from the corner, holds for a corner that is off by -k <s^2> / 2.
Bend bend_of(Pixel before, Pixel middle, Pixel after, int window) {
  const Pixel way = {(after.u - before.u) / 2, (after.v - before.v) / 2};
  const double step = std::hypot(way.u, way.v);
  const Pixel direction = {way.u / step, way.v / step};
  const Pixel normal = {-direction.v, direction.u};
  const double second = normal.u * (after.u - 2 * middle.u + before.u) +
                        normal.v * (after.v - 2 * middle.v + before.v);
  return {normal, second / (step * step) * mean_square(direction, window) / 2};
}

Pixel straightened(const Grid& grid, int col, int row, int window) {
  const int c = std::clamp(col, 1, grid.cols - 2);
  const int r = std::clamp(row, 1, grid.rows - 2);
  const Bend a = bend_of(grid.at(c - 1, row), grid.at(c, row), grid.at(c + 1, row), window);
  const Bend b = bend_of(grid.at(col, r - 1), grid.at(col, r), grid.at(col, r + 1), window);
  const double det = a.normal.u * b.normal.v - a.normal.v * b.normal.u;
  const Pixel p = grid.at(col, row);
  if (!(std::abs(det) > 0.1)) return p;
  return {p.u + (a.offset * b.normal.v - b.offset * a.normal.v) / det,
          p.v + (b.offset * a.normal.u - a.offset * b.normal.u) / det};
}

}  // namespace

bool refine(const cv::Mat& image, Grid& grid) {
  const Grid first = grid;
  std::vector<cv::Point2f> corner(1);
  int runaways = 0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const Pixel from = first.at(col, row);
      const int window = window_at(first, col, row);
      corner[0] = {static_cast<float>(from.u), static_cast<float>(from.v)};
      cv::cornerSubPix(image, corner, {window, window}, {-1, -1},
                       {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 1e-4});
      const Pixel to = {corner[0].x, corner[0].y};
      if (std::hypot(to.u - from.u, to.v - from.v) < 0.3 * spacing_at(first, col, row)) {
        grid.points[static_cast<std::size_t>(row * grid.cols + col)] = to;
      } else {
        ++runaways;
      }
    }
  }
  const Grid bent = grid;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      grid.points[static_cast<std::size_t>(row * grid.cols + col)] =
          straightened(bent, col, row, window_at(first, col, row));
    }
  }
  return 10 * runaways <= grid.cols * grid.rows;
}

}  // namespace calvin::detect
