// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a camera is on a robot, or before one: hand-eye calibration from boards and the poses that
// the robot tells.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "calvin/core/hand_eye.hpp"
#include "calvin/core/result.hpp"
#include "calvin/rig/hand_eye/report.hpp"
#include "calvin/rig/rig_views.hpp"

namespace calvin {

struct HandEyeOptions {
  EyeSetup setup = EyeSetup::kInHand;
  // 1 sigma per axis of the robot's poses, rad and m; estimated where absent.
  std::optional<double> turn_sigma;
  std::optional<double> place_sigma;
  // The size of the board is found with the rest: every length is the robot's. Else the board's
  // size is believed, and HandEye::scale only says how well both agree.
  bool free_scale = false;
};

struct HandEyeSolution {
  HandEye result;
  std::vector<LoopError> loops;
};

// The camera sees one board in all views; `base_from_hand` has a pose for each of them. Intrinsics
// stay as they are; how well they are known is a part of the covariances. The same views give the
// same numbers. kInvalidArgument for broken calibrations, views or poses and for another number of
// poses than of views; kDegenerate for fewer than 3 views that show the board, for a hand that was
// not turned or about one axis only, and for poses that do not go with the views: the message says
// what to do.
[[nodiscard]] Result<HandEyeSolution> solve_hand_eye(const RigCameraViews& camera,
                                                     const std::vector<Pose>& base_from_hand,
                                                     const HandEyeOptions& options = {},
                                                     std::stop_token stop = {});

}  // namespace calvin
