// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One least squares over the places of all cameras and boards. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/rig/joint/board_frame.hpp"
#include "calvin/rig/joint/board_offsets.hpp"
#include "calvin/rig/joint/free_intrinsics.hpp"
#include "calvin/rig/joint/time_offsets.hpp"
#include "calvin/rig/start/rig_start.hpp"

namespace calvin::rig {

struct RigFit {
  RigPlaces places;
  // Over the places of all cameras but the first: d of each as retract() in
  // solve/residuals/bundle_problem.hpp has it, for camera_from_rig.
  Eigen::MatrixXd covariance;
  std::vector<double> camera_rms;                  // px
  double rms = 0;                                  // px, of all corners in use
  std::vector<std::size_t> rejected;               // views that contradict the others
  std::optional<TimeOffsets> time_offsets = {};    // beside those that were allowed for already
  std::optional<BoardOffsets> board_offsets = {};  // beside the labellings of the views
  std::optional<IntrinsicsStep> intrinsics = {};   // where they are free
  std::optional<BoardFrame> board = {};            // where the frame is to be that of a board
};

// What else is asked of a fit.
struct RigFitWishes {
  const FreeIntrinsics* free = nullptr;  // intrinsics that are to be estimated
  const RigWorld* world = nullptr;       // the frame of the rig
};

// From places near the optimum. Intrinsics stay as they are; how well they are known is a part of
// the covariance, by the covariances of `calibrations`, those of different cameras independent, or,
// where they are free, as the least squares over all of them says.
// Corners and views that are far off what the others say are left out. kDegenerate where that
// leaves a camera without views, or its place undetermined; kCancelled where a stop was requested.
[[nodiscard]] Result<RigFit> fit_rig(const std::vector<BoardView>& views, RigPlaces from,
                                     const std::vector<RigCameraViews>& calibrations,
                                     const std::vector<Camera>& cameras, const RigFitWishes& wishes,
                                     const std::stop_token& stop);

}  // namespace calvin::rig
