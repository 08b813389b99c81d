// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where camera and board are, about, and the loops of all views that a least squares begins with.
// Internal.
#pragma once

#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/rig/hand_eye/fit.hpp"
#include "calvin/rig/hand_eye/start.hpp"

namespace calvin::rig {

struct FirstLoops {
  std::vector<Sighting> sightings;
  std::vector<LoopView> loops;  // of each view
  HandEyePlaces places;
  RobotNoise noise;  // by what is left of the loops
};

// By the views of one camera, which must outlive the loops, with a pose of the robot for each.
// kDegenerate where the hand was not turned, the poses do not go with the views, or both leave open
// where the camera is.
[[nodiscard]] Result<FirstLoops> first_loops(const std::vector<const BoardView*>& views,
                                             const std::vector<SE3>& base_from_hand, EyeSetup setup,
                                             bool free_scale);

}  // namespace calvin::rig
