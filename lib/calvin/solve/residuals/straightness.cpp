// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Straight lines through the rows and columns of boards, with distortion and without.

#include "calvin/solve/residuals/straightness.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace calvin {

namespace {

// A point as it is seen, and where a pinhole would see it, px.
struct Place {
  Eigen::Vector2d seen;
  Eigen::Vector2d mended;
};

// Of each row, then of each column.
using Lines = std::map<std::pair<bool, int>, std::vector<Place>>;

Lines lines_of(const View& view, const Grid& grid, const std::vector<int>& left_out,
               const Camera& camera) {
  Lines lines;
  const Observation& seen = view.observation;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    if (std::ranges::find(left_out, seen.ids[i]) != left_out.end()) continue;
    const auto ray = camera.unproject(seen.uv[i]);
    if (!ray || !(ray->z() > 0)) continue;
    const Place place = {{seen.uv[i].u, seen.uv[i].v},
                         {camera.fx() * ray->x() / ray->z() + camera.cx(),
                          camera.fy() * ray->y() / ray->z() + camera.cy()}};
    const GridPlace at = grid.place(seen.ids[i]);
    lines[{false, at.row}].push_back(place);
    lines[{true, at.col}].push_back(place);
  }
  return lines;
}

// The sum of the squares of the distances from the best line: the smaller eigenvalue of the
// scatter.
double square_off(const std::vector<Place>& places, Eigen::Vector2d Place::*which) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Place& p : places) mean += p.*which / static_cast<double>(places.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Place& p : places) {
    const Eigen::Vector2d d = p.*which - mean;
    scatter += d * d.transpose();
  }
  const double half = 0.5 * (scatter(0, 0) + scatter(1, 1));
  const double root = std::hypot(0.5 * (scatter(0, 0) - scatter(1, 1)), scatter(0, 1));
  return std::max(half - root, 0.0);
}

}  // namespace

std::optional<Straightness> straightness(std::span<const View> views,
                                         std::span<const RejectedCorner> left_out,
                                         const Camera& camera) {
  constexpr std::size_t kFewest = 5;  // points of a line
  Straightness sum;
  double points = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto grid = views[v].board.grid();
    if (!grid) continue;
    std::vector<int> without;
    for (const RejectedCorner& corner : left_out) {
      if (corner.view == v) without.push_back(corner.id);
    }
    for (const auto& [line, places] : lines_of(views[v], *grid, without, camera)) {
      if (places.size() < kFewest) continue;
      ++sum.lines;
      points += static_cast<double>(places.size());
      sum.seen += square_off(places, &Place::seen);
      sum.mended += square_off(places, &Place::mended);
    }
  }
  if (sum.lines == 0) return std::nullopt;
  sum.seen = std::sqrt(sum.seen / points);
  sum.mended = std::sqrt(sum.mended / points);
  return sum;
}

}  // namespace calvin
