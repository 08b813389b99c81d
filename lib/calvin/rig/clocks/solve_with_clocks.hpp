// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Joint solves of a rig whose cameras may have clocks that disagree. Internal.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/rig/joint/rig_fit.hpp"
#include "calvin/rig/start/links.hpp"

namespace calvin::rig {

struct JointProblem {
  const std::vector<RigCameraViews>& seen;
  const std::vector<Camera>& cameras;
  std::vector<BoardView> views;    // as they were seen
  std::vector<std::string> names;  // of the cameras
  std::uint64_t tolerance = 0;     // ns
  InstantsOf instants = InstantsOf::kTwoCameras;
  RigFitWishes wishes = {};
};

struct JointSolve {
  std::vector<BoardView> views;  // where boards were at the first picture of each instant
  std::vector<Link> links;
  std::uint64_t farthest = 0;   // ns, between two pictures of one instant
  std::vector<double> offsets;  // of the clock of each camera, s; empty where they agree
  RigFit fit;                   // how well offsets are known is a part of the covariance
};

// Pairs, places and fits. Clocks are taken to agree unless corners that move say otherwise; then
// what they are off by is one more unknown of each camera (P. Furgale, J. Rehder, R. Siegwart,
// Unified temporal and spatial calibration for multi-sensor systems, IROS 2013, between cameras).
// Errors are those of place_all() and fit_rig().
[[nodiscard]] Result<JointSolve> solve_with_clocks(JointProblem problem,
                                                   const std::stop_token& stop);

}  // namespace calvin::rig
