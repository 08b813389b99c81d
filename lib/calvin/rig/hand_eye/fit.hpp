// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One least squares over the places of camera and board, all views, and where that is asked for the
// cameras and the aspect of the board too, with the noise of corners and robot. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/rig/hand_eye/loop_corners.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"

namespace calvin::rig {

// 1 sigma per axis of a pose of the robot.
struct RobotNoise {
  double turn = 0;   // rad
  double place = 0;  // m
};

struct HandEyeTask {
  EyeSetup setup = EyeSetup::kInHand;
  bool free_scale = false;
  std::optional<double> turn_sigma;  // of the robot, where that is known
  std::optional<double> place_sigma;
  bool free_cameras = false;  // intrinsics, and the places of cameras before the first one
  bool free_aspect = false;
};

struct HandEyeFit {
  HandEyePlaces places;
  MountedCameras mounted;
  double aspect = 1;
  std::vector<SE3> camera_from_board;  // of all loops, by the first camera
  // Over all unknowns: those of `table`, then those of HandEyePlaces; 0 for what is held.
  Eigen::MatrixXd covariance;
  ParameterTable table;
  RobotNoise noise;        // as given, else as found
  RobotNoise found;        // by the loops, whatever was given
  double corner = 1;       // px, the sigma of a corner with the weight 1
  LoopCorners::Rms rms;    // px, not weighted, of the corners in use
  std::vector<bool> used;  // of the loops; the others contradict them

  // Of the unknowns of HandEyePlaces.
  [[nodiscard]] Eigen::MatrixXd covariance_of_places() const {
    return covariance.bottomRightCorner(kPlaceColumns, kPlaceColumns);
  }
};

// From places near the optimum. Where the cameras are not free, how well their intrinsics are
// known, by the covariances of `calibrations`, is a part of the covariance; there is one camera
// then. kDegenerate where the views do not determine the unknowns; kCancelled where a stop was
// requested.
[[nodiscard]] Result<HandEyeFit> fit_hand_eye(const std::vector<LoopView>& loops,
                                              const HandEyePlaces& start, const RobotNoise& noise,
                                              const MountedCameras& mounted,
                                              const std::vector<RigCameraViews>& calibrations,
                                              const HandEyeTask& task, const std::stop_token& stop);

}  // namespace calvin::rig
