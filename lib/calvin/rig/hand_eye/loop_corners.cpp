// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Distances of corners from where the loops have them.

#include "calvin/rig/hand_eye/loop_corners.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "calvin/geometry/median.hpp"
#include "calvin/rig/hand_eye/start.hpp"

namespace calvin::rig {

namespace {

constexpr double kMedianDistance = 1.17741;  // of two normal coordinates, in their sigma

Eigen::Vector3d stretched_point(const Eigen::Vector3d& point, double aspect) {
  return {point.x(), aspect * point.y(), point.z()};
}

// Of the corners in use, weighted, px; 0 for the others.
std::vector<double> distances(const PointSet& seen, const Camera& camera, const SE3& pose,
                              double aspect) {
  std::vector<double> all;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto at = camera.project(pose * stretched_point(seen.points[i], aspect));
    const bool counts = at && seen.weight[i] > 0;
    all.push_back(counts ? seen.weight[i] * std::hypot(at->u - seen.uv[i].u, at->v - seen.uv[i].v)
                         : 0);
  }
  return all;
}

// Rows farther apart from the first one, as the labels of the board have it; curved boards and
// labels of the views do not matter.
BoardShape aspect_shape(const PointSet& seen) {
  BoardShape shape;
  shape.modes = 1;
  shape.unknowns.has_aspect = true;
  for (const Eigen::Vector3d& point : seen.points) shape.displacement.emplace_back(0, point.y(), 0);
  return shape;
}

}  // namespace

PointSet with_labels(const SeenBoard& seen, double aspect) {
  PointSet points = seen.view->seen;
  for (Eigen::Vector3d& point : points.points) {
    point = stretched_point(seen.board_from_own * point, aspect);
  }
  points.motion.clear();
  return points;
}

LoopCorners::LoopCorners(const std::vector<LoopView>& loops, bool has_aspect)
    : has_aspect_(has_aspect) {
  for (std::size_t loop = 0; loop < loops.size(); ++loop) {
    for (const SeenBoard& seen : loops[loop].seen) {
      Set set = {loop, seen.view->of.camera, seen.camera_from_board, with_labels(seen, 1), {}};
      // The displacements of the aspect stand in the order of the points.
      std::iota(set.all.ids.begin(), set.all.ids.end(), 0);
      set.used = set.all;
      sets_.push_back(std::move(set));
    }
  }
  make_arrays();
}

LoopCorners::Kept LoopCorners::leave_out_by_views(const std::vector<Camera>& cameras) {
  std::vector<std::vector<double>> far;
  for (const Set& set : sets_) {
    far.push_back(distances(set.all, cameras[set.camera], set.by_view, 1));
  }
  return leave_out(far);
}

LoopCorners::Kept LoopCorners::leave_out(const LoopGeometry& geometry) {
  std::vector<std::vector<double>> far;
  for (const Set& set : sets_) {
    const SE3 pose =
        geometry.mounted.camera_from_first[set.camera] * geometry.camera_from_board[set.loop];
    far.push_back(distances(set.all, geometry.mounted.cameras[set.camera], pose, geometry.aspect));
  }
  return leave_out(far);
}

LoopCorners::Kept LoopCorners::leave_out(const std::vector<std::vector<double>>& far) {
  constexpr double kFar = 6;  // sigmas
  constexpr std::size_t kFewest = 4;
  std::vector<double> all;
  for (const std::vector<double>& of_set : far) {
    std::ranges::copy_if(of_set, std::back_inserter(all), [](double d) { return d > 0; });
  }
  if (all.empty()) return {};
  Kept kept = {std::max(median_of(std::move(all)) / kMedianDistance, 1e-9), false};
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    PointSet cleaned = sets_[s].all;
    for (std::size_t i = 0; i < far[s].size(); ++i) {
      if (far[s][i] > kFar * kept.sigma) cleaned.weight[i] = 0;
    }
    if (cleaned.used() < kFewest) cleaned = sets_[s].all;
    kept.changed |= cleaned.weight != sets_[s].used.weight;
    sets_[s].used = std::move(cleaned);
  }
  make_arrays();
  return kept;
}

void LoopCorners::make_arrays() {
  points_.clear();
  for (const Set& set : sets_) {
    points_.emplace_back(set.used, has_aspect_ ? aspect_shape(set.used) : BoardShape());
  }
}

std::vector<SeenByCamera> LoopCorners::seen(std::size_t loop) const {
  std::vector<SeenByCamera> all;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    if (sets_[s].loop == loop) all.push_back({&points_[s], sets_[s].camera});
  }
  return all;
}

std::size_t LoopCorners::count(std::size_t loop) const {
  std::size_t count = 0;
  for (const Set& set : sets_) count += set.loop == loop ? set.used.used() : 0;
  return count;
}

LoopCorners::Rms LoopCorners::rms(const LoopGeometry& geometry,
                                  const std::vector<bool>& used) const {
  const std::size_t cameras = geometry.mounted.cameras.size();
  std::vector<double> squares(cameras, 0.0);
  std::vector<double> corners(cameras, 0.0);
  for (const Set& set : sets_) {
    if (!used[set.loop]) continue;
    const SE3 pose =
        geometry.mounted.camera_from_first[set.camera] * geometry.camera_from_board[set.loop];
    const auto far =
        distances(set.used, geometry.mounted.cameras[set.camera], pose, geometry.aspect);
    for (std::size_t i = 0; i < far.size(); ++i) {
      if (!(set.used.weight[i] > 0)) continue;
      squares[set.camera] += std::pow(far[i] / set.used.weight[i], 2);
      corners[set.camera] += 1;
    }
  }
  const auto root = [](double sum, double count) { return count > 0 ? std::sqrt(sum / count) : 0; };
  Rms rms;
  for (std::size_t c = 0; c < cameras; ++c) rms.of_cameras.push_back(root(squares[c], corners[c]));
  rms.all = root(std::accumulate(squares.begin(), squares.end(), 0.0),
                 std::accumulate(corners.begin(), corners.end(), 0.0));
  return rms;
}

}  // namespace calvin::rig
