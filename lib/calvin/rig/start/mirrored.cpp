// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The mirrors as matrices.

#include "calvin/rig/start/mirrored.hpp"

namespace calvin::rig {

SE3 mirror_before_camera(Pictures pictures) {
  SE3 mirror;
  if (pictures == Pictures::kMirrored) mirror.rotation(0, 0) = -1;
  return mirror;
}

std::vector<SE3> mirrors_of_board(const Eigen::Vector3d& middle, Pictures pictures) {
  if (pictures == Pictures::kAsTheyAre) return {SE3()};
  std::vector<SE3> all;
  for (const bool is_diagonal : {false, true}) {
    for (const double side : {-1.0, 1.0}) {
      Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
      m.topLeftCorner<2, 2>() = is_diagonal ? (Eigen::Matrix2d() << 0, side, side, 0).finished()
                                            : (Eigen::Matrix2d() << side, 0, 0, -side).finished();
      all.push_back({m, middle - m * middle});
    }
  }
  return all;
}

}  // namespace calvin::rig
