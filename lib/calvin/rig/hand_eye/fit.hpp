// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One least squares over the places of camera and board and all views, with the noise of corners
// and robot. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/rig/board_views.hpp"
#include "calvin/rig/hand_eye/start.hpp"

namespace calvin::rig {

// A view, the pose of its board by its corners alone, and what the robot told.
struct LoopView {
  const BoardView* view = nullptr;
  BoardPose pose;
  SE3 base_from_hand;
};

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
};

struct HandEyeFit {
  HandEyePlaces places;
  // Over the unknowns of HandEyePlaces, without the scale where that is held.
  Eigen::MatrixXd covariance;
  RobotNoise noise;        // as given, else as found
  RobotNoise found;        // by the loops, whatever was given
  double corner = 1;       // px, the sigma of a corner with the weight 1
  double rms = 0;          // px, not weighted, of the corners in use
  std::vector<bool> used;  // of the views; the others contradict them
};

// From places near the optimum. Intrinsics stay as they are; how well they are known, by the
// covariance of `calibration`, is a part of the covariance. kDegenerate where the views do not
// determine the places; kCancelled where a stop was requested.
[[nodiscard]] Result<HandEyeFit> fit_hand_eye(const std::vector<LoopView>& views,
                                              const HandEyePlaces& start, const RobotNoise& noise,
                                              const RigCameraViews& calibration,
                                              const Camera& camera, const HandEyeTask& task,
                                              const std::stop_token& stop);

}  // namespace calvin::rig
