// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the corners of two views of a board that are one.

#include "calvin/rig/common_corners.hpp"

namespace calvin::rig {

std::vector<CommonCorner> common_corners(const BoardView& a, const BoardView& b,
                                         const SE3& first_from_second,
                                         const std::vector<Eigen::Vector3d>& rays_a,
                                         const std::vector<Eigen::Vector3d>& rays_b) {
  constexpr double kSame = 1e-6;  // m
  std::vector<CommonCorner> corners;
  const std::size_t count = a.seen.size();
  std::size_t next = 0;  // mostly both list the points of the board in one order
  for (std::size_t j = 0; j < b.seen.size(); ++j) {
    const Eigen::Vector3d point = first_from_second * b.seen.points[j];
    std::size_t tried = 0;
    while (tried < count &&
           !((a.seen.points[(next + tried) % count] - point).squaredNorm() < kSame * kSame)) {
      ++tried;
    }
    if (tried == count) continue;
    const std::size_t i = (next + tried) % count;
    next = i + 1;
    if (!(a.seen.weight[i] > 0) || !(b.seen.weight[j] > 0)) continue;
    if (rays_a[i].isZero(0) || rays_b[j].isZero(0)) continue;
    corners.push_back({point, rays_a[i], rays_b[j]});
  }
  return corners;
}

}  // namespace calvin::rig
