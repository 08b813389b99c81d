// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One camera before one board that lies still. Internal.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/board_views.hpp"

namespace calvin::rig {

struct FloorPose {
  SE3 camera_from_board;
  // Of a turn about the axes of the board and of the place of the camera in its frame, m.
  Eigen::Matrix<double, 6, 6> covariance;
  double rms = 0;              // px, not weighted
  bool has_two_tilts = false;  // the mirrored tilt explains the corners nearly as well
};

// By all views of the board, which are of `calibration`. How well its intrinsics are known is a
// part of the covariance. kDegenerate where the board has moved between the views.
[[nodiscard]] Result<FloorPose> floor_pose(const std::vector<BoardView>& views,
                                           const Calibration& calibration, const Camera& camera);

// Sentences: that the place is known little, and that the tilt may be the other one. `name` is that
// of the camera.
[[nodiscard]] std::vector<std::string> floor_remarks(const FloorPose& pose,
                                                     const std::string& name);

}  // namespace calvin::rig
