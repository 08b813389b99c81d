// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The loops of several cameras on one mount that a least squares begins with. Internal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/rig/hand_eye/first_loops.hpp"

namespace calvin::rig {

struct JointLoops {
  FirstLoops first;                // by the first camera
  std::vector<LoopView> loops;     // of each pose of the robot at which a camera has seen the board
  std::vector<std::size_t> poses;  // their numbers
  MountedCameras mounted;
};

// By the views of all cameras, in the order of board_views(), with the number of the pose of the
// robot for each. kDegenerate as first_loops() by the first camera alone, and where the others have
// seen too little at the same poses.
[[nodiscard]] Result<JointLoops> joint_loops(const std::vector<BoardView>& views,
                                             const std::vector<std::size_t>& pose_of_view,
                                             const std::vector<SE3>& base_from_hand,
                                             const std::vector<Camera>& cameras,
                                             const std::vector<std::string>& names, EyeSetup setup,
                                             bool free_scale);

}  // namespace calvin::rig
