// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners that two cameras have seen at one time, whatever labels each gave them. Internal.
#pragma once

#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/board_views.hpp"

namespace calvin::rig {

struct CommonCorner {
  Eigen::Vector3d on_board;  // m, by the labels of the first view
  Eigen::Vector3d ray_a;     // frame of the first camera
  Eigen::Vector3d ray_b;     // frame of the second
};

// Of one board, the corners that are in use in both views; `first_from_second` are its frames by
// their labels, and the rays those of all corners of each view, zero where there is none.
[[nodiscard]] std::vector<CommonCorner> common_corners(const BoardView& a, const BoardView& b,
                                                       const SE3& first_from_second,
                                                       const std::vector<Eigen::Vector3d>& rays_a,
                                                       const std::vector<Eigen::Vector3d>& rays_b);

}  // namespace calvin::rig
