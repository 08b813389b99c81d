// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How well one view of a board says where it is before a camera of known intrinsics. Internal.
#pragma once

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin::rig {

// Both of a turn of the camera about the axes of the board (rad), then of the place of the camera
// in the frame of the board (m).
struct PoseCovariance {
  Eigen::Matrix<double, 6, 6> of_noise;
  Eigen::Matrix<double, 6, 6> of_lens;  // the same for all views; 0 where no covariance is known
};

// By the normal equations at the optimum `camera_from_board` of the corners in use, Jacobians by
// differences. `variance`: px^2 of a corner with the weight 1.
[[nodiscard]] PoseCovariance pose_covariance(const PointSet& seen, const Calibration& calibration,
                                             const Camera& camera, const SE3& camera_from_board,
                                             double variance);

}  // namespace calvin::rig
