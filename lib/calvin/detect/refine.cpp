// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/refine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace calvin::detect {

namespace {

constexpr int kLeastWindow = 2;  // px, half of the side
constexpr int kLargestWindow = 12;
constexpr double kWindowShare = 0.5;  // of the distance between grid lines
constexpr double kOpticsBlur = 0.8;   // px, of a usual camera, the pixel's own square included
constexpr double kSigma = 0.1;        // px, what a good view of a real board leaves
constexpr double kRoughSigma = 0.5;   // px, of a corner that was left where it was found

// The mean of s^2 along a line through the window's centre, weighted as cv::cornerSubPix does:
// exp(-s^2 / window^2) inside a square; and by the square of the contrast, which fades towards the
// corner where the image is blurred.
double mean_square(Pixel direction, int window, double blur) {
  constexpr int kSteps = 32;
  const double end = (window + 0.5) / std::max(std::abs(direction.u), std::abs(direction.v));
  double sum = 0;
  double weights = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) * end / kSteps;
    const double contrast = std::erf(s / (blur * std::numbers::sqrt2));
    const double weight = contrast * contrast * std::exp(-s * s / (window * window));
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
Bend bend_of(Pixel before, Pixel middle, Pixel after, int window, double blur) {
  const Pixel way = {(after.u - before.u) / 2, (after.v - before.v) / 2};
  const double step = std::hypot(way.u, way.v);
  const Pixel direction = {way.u / step, way.v / step};
  const Pixel normal = {-direction.v, direction.u};
  const double second = normal.u * (after.u - 2 * middle.u + before.u) +
                        normal.v * (after.v - 2 * middle.v + before.v);
  return {normal, second / (step * step) * mean_square(direction, window, blur) / 2};
}

// The bend at place `at` of a line of `count` corners; at its ends it goes on as it changed before.
template <typename PointAt>
Bend bend_at(const PointAt& point, int at, int count, int window, double blur) {
  const int inner = std::clamp(at, 1, count - 2);
  Bend bend = bend_of(point(inner - 1), point(inner), point(inner + 1), window, blur);
  const int next = inner + (inner - at);
  if (next != inner && next >= 1 && next <= count - 2) {
    const Bend other = bend_of(point(next - 1), point(next), point(next + 1), window, blur);
    bend.offset += bend.offset - other.offset;
  }
  return bend;
}

Pixel straightened(const Grid& grid, int col, int row, int window, double blur) {
  const auto along = [&](int c) { return grid.at(c, row); };
  const auto down = [&](int r) { return grid.at(col, r); };
  const Bend a = bend_at(along, col, grid.cols, window, blur);
  const Bend b = bend_at(down, row, grid.rows, window, blur);
  const double det = a.normal.u * b.normal.v - a.normal.v * b.normal.u;
  const Pixel p = grid.at(col, row);
  if (!(std::abs(det) > 0.1)) return p;
  return {p.u + (a.offset * b.normal.v - b.offset * a.normal.v) / det,
          p.v + (b.offset * a.normal.u - a.offset * b.normal.u) / det};
}

// One corner; false where it runs away.
bool refine_corner(const cv::Mat& image, int window, double spacing, Pixel& at) {
  std::vector<cv::Point2f> corner = {{static_cast<float>(at.u), static_cast<float>(at.v)}};
  cv::cornerSubPix(image, corner, {window, window}, {-1, -1},
                   {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 1e-4});
  const Pixel to = {corner[0].x, corner[0].y};
  const double limit = std::min(0.3 * spacing, std::max(2.0, 0.5 * window));
  if (!(std::hypot(to.u - at.u, to.v - at.v) < limit)) return false;
  at = to;
  return true;
}

}  // namespace

bool refine(const cv::Mat& sharp, Grid& grid, std::vector<double>& sigma) {
  const double smoothing = std::clamp(0.08 * least_spacing(grid), 0.4, 1.3);
  cv::Mat image;
  cv::GaussianBlur(sharp, image, {0, 0}, smoothing);

  const std::size_t count = grid.points.size();
  const double blur = std::hypot(smoothing, kOpticsBlur);
  std::vector<int> windows(count);
  sigma.assign(count, kSigma);
  std::size_t runaways = 0;
  Grid bent = grid;
  for (std::size_t i = 0; i < count; ++i) {
    const int col = static_cast<int>(i) % grid.cols;
    const int row = static_cast<int>(i) / grid.cols;
    const double spacing = spacing_at(grid, col, row);
    windows[i] = std::clamp(static_cast<int>(kWindowShare * spacing), kLeastWindow, kLargestWindow);
    if (!refine_corner(image, windows[i], spacing, bent.points[i])) {
      sigma[i] = kRoughSigma;
      ++runaways;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const int col = static_cast<int>(i) % grid.cols;
    const int row = static_cast<int>(i) / grid.cols;
    grid.points[i] = straightened(bent, col, row, windows[i], blur);
  }
  return 10 * runaways <= count;
}

}  // namespace calvin::detect
