// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Observations as points with weights.

#include "calvin/solve/residuals/points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calvin/camera/image_transform.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/points/id_index.hpp"

namespace calvin {

namespace {

// Absent where the detector says nothing of the corner, or nothing that can be.
std::optional<double> weight_of(const Observation& observation, std::size_t i) {
  if (i >= observation.sigma.size()) return std::nullopt;
  const double sigma = observation.sigma[i];
  if (!is_known_sigma(sigma)) return std::nullopt;
  return 1 / sigma;
}

}  // namespace

std::size_t PointSet::used() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0; }));
}

PointSet PointSet::without_corners() const {
  PointSet bare;
  bare.index = index;
  bare.board = board;
  bare.timestamp = timestamp;
  bare.sigma_known = sigma_known;
  bare.ambiguous = ambiguous;
  return bare;
}

void PointSet::reserve(std::size_t corners) {
  ids.reserve(corners);
  points.reserve(corners);
  uv.reserve(corners);
  weight.reserve(corners);
  motion.reserve(corners);
}

void PointSet::append(const PointSet& from, std::size_t i) {
  ids.push_back(from.ids[i]);
  points.push_back(from.points[i]);
  uv.push_back(from.uv[i]);
  weight.push_back(from.weight[i]);
  if (!from.motion.empty()) motion.push_back(from.motion[i]);
}

PointSet to_points(const Board& board, const std::vector<Eigen::Vector3d>& points,
                   const Observation& observation) {
  PointSet view;
  view.timestamp = observation.timestamp;
  view.ambiguous = !observation.ambiguous.empty();
  const IdIndex board_ids(board);
  view.uv = observation.uv;
  view.ids.resize(observation.ids.size());
  view.points.resize(view.ids.size());
  view.weight.resize(view.ids.size());
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const std::size_t index = board_ids.of(observation.ids[i]).value();
    view.ids[i] = static_cast<int>(index);
    view.points[i] = points[index];
    const auto weight = weight_of(observation, i);
    view.weight[i] = weight.value_or(1);
    view.sigma_known = view.sigma_known && weight;
  }
  return view;
}

// A velocity is the difference between two frames, between whose rows as much time has passed as
// between the frames, but for what the corner has moved across the rows: `rate` mends that.
std::vector<RowMotion> row_motion(const Observation& observation, int height) {
  std::vector<RowMotion> motion;
  motion.reserve(observation.velocity.size());
  for (std::size_t i = 0; i < observation.velocity.size(); ++i) {
    const Pixel& speed = observation.velocity[i];
    const double delay = row_delay(observation.uv[i].v, height);
    motion.push_back({{speed.u * delay, speed.v * delay}, speed.v / std::max(height - 1, 1)});
  }
  return motion;
}

bool spans_plane(const PointSet& view) {
  const auto first =
      std::find_if(view.weight.begin(), view.weight.end(), [](double w) { return w > 0; });
  if (first == view.weight.end()) return false;
  const Eigen::Vector3d& origin =
      view.points[static_cast<std::size_t>(first - view.weight.begin())];
  double n = 0;
  double x = 0;
  double y = 0;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    const double dx = view.points[i].x() - origin.x();
    const double dy = view.points[i].y() - origin.y();
    n += 1;
    x += dx;
    y += dy;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  if (n < 4) return false;
  xx -= x * x / n;
  xy -= x * y / n;
  yy -= y * y / n;
  // The product of the eigenvalues of the scatter: on one line it is zero.
  const double trace = xx + yy;
  return xx * yy - xy * xy > 1e-8 * trace * trace;
}

}  // namespace calvin
