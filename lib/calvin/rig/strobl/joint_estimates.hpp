// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a joint fit says in the terms of files: intrinsics, places in the robot's metres, lengths of
// the board, with one covariance. Internal.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/hand_eye/fit.hpp"

namespace calvin::rig {

struct JointEstimates {
  std::vector<std::string> names;  // of rows: "left.fx", "right.tx", "mount.rx", "aspect"
  Eigen::MatrixXd covariance;
  std::vector<ParameterRange> intrinsics;  // rows of each camera
  std::vector<ParameterRange> places;      // in the frame of the first camera, which has none
  ParameterRange scale;                    // empty where it is held
  ParameterRange aspect;
};

// Turns (rad) are about the axes of the frame that a pose is in, places are in the robot's metres.
// `names` are those of the cameras.
[[nodiscard]] JointEstimates joint_estimates(const HandEyeFit& fit, const HandEyeTask& task,
                                             const std::vector<std::string>& names);

// Of each camera, with what is known of it beside its intrinsics, `known`.
[[nodiscard]] std::vector<Calibration> joint_calibrations(const HandEyeFit& fit,
                                                          const JointEstimates& estimates,
                                                          const std::vector<LoopView>& loops,
                                                          const std::vector<Calibration>& known,
                                                          const std::string& board);

// The frame is that of the first camera.
[[nodiscard]] Rig joint_rig(const HandEyeFit& fit, const JointEstimates& estimates,
                            const std::vector<Calibration>& calibrations);

// kDegenerate where a focal length, a principal point, the size of the board or its aspect is not
// determined, with what to do.
[[nodiscard]] Status check_determined(const HandEyeFit& fit, const JointEstimates& estimates,
                                      const std::vector<std::string>& names);

}  // namespace calvin::rig
