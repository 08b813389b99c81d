// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras on a robot, or before one, and the board that they see, all unknown: intrinsics, where
// the cameras are to the robot and to each other, where the board is, its pitch and its aspect, in
// one least squares. The method of CalLab: K. H. Strobl, G. Hirzinger, Optimal Hand-Eye
// Calibration, IROS 2006; More Accurate Camera and Hand-Eye Calibrations with Unknown Grid Pattern
// Dimensions, ICRA 2008.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/hand_eye.hpp"
#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/hand_eye/report.hpp"
#include "calvin/rig/rig_views.hpp"

namespace calvin {

struct StroblOptions {
  EyeSetup setup = EyeSetup::kInHand;
  // 1 sigma per axis of the robot's poses, rad and m; estimated where absent.
  std::optional<double> turn_sigma;
  std::optional<double> place_sigma;
  bool pitch_known = false;   // the board is as large as its text says
  bool aspect_known = false;  // its rows are as far apart as its columns
};

// A camera, and of which pose of the robot each of its views is.
struct RobotCamera {
  RigCameraViews seen;  // the calibration is where the solve begins
  std::vector<std::size_t> pose_of_view;
};

struct StroblSolution {
  // Of the first camera. `scale` is the pitch of the board over what its text says, `aspect` how
  // much farther apart its rows are than its columns; both are absent where they were known.
  HandEye hand_eye;
  std::vector<Calibration> calibrations;  // of each camera
  // Several cameras: in metres of the robot, the frame is that of the first camera.
  std::optional<Rig> rig;
  std::vector<LoopError> loops;  // of each pose at which a board was seen; `view` is its number
  // What was estimated, and its covariance row after row: "left.fx", then "right.rx" of where
  // further cameras are in the frame of the first one, "mount.tx", "carrier.tx", "scale", "aspect".
  // Turns (rad) are about the axes of the frame that a pose is in.
  std::vector<std::string> names;
  std::vector<double> covariance;
};

// The cameras stand fixed to each other, and see one board. What was known of the intrinsics before
// is a start and no measurement: the views may be those that it came from. The same views give the
// same numbers. kInvalidArgument for broken calibrations, views or poses, and for cameras of one
// name; kDegenerate where views and poses leave open what is asked for (see check_determined() and
// solve_hand_eye()): the message says what to do.
[[nodiscard]] Result<StroblSolution> solve_strobl(const std::vector<RobotCamera>& cameras,
                                                  const std::vector<Pose>& base_from_hand,
                                                  const StroblOptions& options = {},
                                                  std::stop_token stop = {});

}  // namespace calvin
