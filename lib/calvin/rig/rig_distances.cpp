// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Triangulates the corners that both cameras have seen.

#include "calvin/rig/rig_distances.hpp"

#include <algorithm>
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

// Corners of a board that both views show; `first_from_second` are its frames by their labels.
std::vector<Corner> corners_of(const BoardView& a, const BoardView& b, const SE3& first_from_second,
                               const Camera& camera_a, const Camera& camera_b,
                               const SE3& a_from_b) {
  constexpr double kSame = 1e-6;  // m
  std::vector<Corner> corners;
  for (std::size_t j = 0; j < b.seen.size(); ++j) {
    const Eigen::Vector3d point = first_from_second * b.seen.points[j];
    const auto same = std::ranges::find_if(
        a.seen.points, [&](const Eigen::Vector3d& p) { return (p - point).norm() < kSame; });
    if (same == a.seen.points.end()) continue;
    const auto i = static_cast<std::size_t>(same - a.seen.points.begin());
    if (!(a.seen.weight[i] > 0) || !(b.seen.weight[j] > 0)) continue;
    const auto ray_a = camera_a.unproject(a.seen.uv[i]);
    const auto ray_b = camera_b.unproject(b.seen.uv[j]);
    const auto met = ray_a && ray_b ? meet(*ray_a, *ray_b, a_from_b) : std::nullopt;
    if (met) corners.push_back({point, *met});
  }
  return corners;
}

}  // namespace

std::optional<DistanceError> distance_error(const std::vector<BoardView>& views,
                                            const std::vector<CommonView>& common,
                                            const std::vector<SE3>& board_from_own,
                                            const Camera& camera_a, const Camera& camera_b,
                                            const SE3& b_from_a) {
  struct Pair {
    double on_board;
    double seen;
  };
  std::vector<Pair> pairs;
  double on_board = 0;
  double seen = 0;
  for (const CommonView& c : common) {
    const SE3 first_from_second = board_from_own[c.a].inverse() * board_from_own[c.b];
    const auto corners = corners_of(views[c.a], views[c.b], first_from_second, camera_a, camera_b,
                                    b_from_a.inverse());
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
