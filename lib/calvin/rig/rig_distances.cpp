// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Triangulates the corners that both cameras have seen.

#include "calvin/rig/rig_distances.hpp"

#include <cmath>

namespace calvin::rig {

namespace {

struct Corner {
  Eigen::Vector3d on_board;
  Eigen::Vector3d seen;  // frame of the first camera
};

// The point nearest to both rays, in the frame of the first camera. Absent for rays that are nearly
// parallel.
std::optional<Eigen::Vector3d> meet(const Eigen::Vector3d& ray_a, const Eigen::Vector3d& ray_b,
                                    const SE3& a_from_b) {
  constexpr double kLeastSine = 0.0175;  // of a degree
  const Eigen::Vector3d other = a_from_b.rotation * ray_b;
  const Eigen::Vector3d normal = ray_a.cross(other);
  const double square = normal.squaredNorm();
  if (square < kLeastSine * kLeastSine) return std::nullopt;
  const Eigen::Vector3d& base = a_from_b.translation;
  const double along_a = base.cross(other).dot(normal) / square;
  const double along_b = base.cross(ray_a).dot(normal) / square;
  return 0.5 * (along_a * ray_a + base + along_b * other);
}

std::vector<Corner> met(const std::vector<CommonCorner>& common, const SE3& a_from_b) {
  std::vector<Corner> corners;
  for (const CommonCorner& c : common) {
    if (const auto point = meet(c.ray_a, c.ray_b, a_from_b)) {
      corners.push_back({c.on_board, *point});
    }
  }
  return corners;
}

}  // namespace

std::optional<DistanceError> distance_error(const std::vector<std::vector<CommonCorner>>& views,
                                            const SE3& b_from_a) {
  struct Pair {
    double on_board;
    double seen;
  };
  std::vector<Pair> pairs;
  double on_board = 0;
  double seen = 0;
  for (const std::vector<CommonCorner>& view : views) {
    const std::vector<Corner> corners = met(view, b_from_a.inverse());
    // Each corner and the one half of them further: pairs that are far apart, and no corner twice.
    const std::size_t half = corners.size() / 2;
    for (std::size_t i = 0; i < half; ++i) {
      const Corner& p = corners[i];
      const Corner& q = corners[i + half];
      pairs.push_back({(p.on_board - q.on_board).norm(), (p.seen - q.seen).norm()});
      on_board += pairs.back().on_board;
      seen += pairs.back().seen;
    }
  }
  if (pairs.empty() || !(on_board > 0)) return std::nullopt;
  DistanceError error;
  error.bias = seen / on_board - 1;
  double squares = 0;
  for (const Pair& pair : pairs) {
    const double left = pair.seen - (1 + error.bias) * pair.on_board;
    squares += left * left;
  }
  error.spread = std::sqrt(squares / static_cast<double>(pairs.size()));
  return error;
}

}  // namespace calvin::rig
