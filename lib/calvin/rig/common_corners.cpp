// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the corners of two views of a board that are one.

#include "calvin/rig/common_corners.hpp"

#include <algorithm>

namespace calvin::rig {

std::vector<CommonCorner> common_corners(const BoardView& a, const BoardView& b,
                                         const SE3& first_from_second, const Camera& camera_a,
                                         const Camera& camera_b) {
  constexpr double kSame = 1e-6;  // m
  std::vector<CommonCorner> corners;
  for (std::size_t j = 0; j < b.seen.size(); ++j) {
    const Eigen::Vector3d point = first_from_second * b.seen.points[j];
    const auto same = std::ranges::find_if(
        a.seen.points, [&](const Eigen::Vector3d& p) { return (p - point).norm() < kSame; });
    if (same == a.seen.points.end()) continue;
    const auto i = static_cast<std::size_t>(same - a.seen.points.begin());
    if (!(a.seen.weight[i] > 0) || !(b.seen.weight[j] > 0)) continue;
    const auto ray_a = camera_a.unproject(a.seen.uv[i]);
    const auto ray_b = camera_b.unproject(b.seen.uv[j]);
    if (ray_a && ray_b) corners.push_back({point, *ray_a, *ray_b});
  }
  return corners;
}

}  // namespace calvin::rig
