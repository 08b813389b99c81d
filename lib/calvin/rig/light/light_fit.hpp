// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The whole solve of cameras before a light, from what they have seen to covariances. Internal.
#pragma once

#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/rig/light/light_unknowns.hpp"

namespace calvin::rig {

struct LightFit {
  LightUnknowns unknowns;
  LightState state;
  // Over all unknowns of the table, for motions of retract(): zero for what is held. Calibrations
  // that were given count with their covariances.
  Eigen::MatrixXd covariance;
  double variance = 0;  // of the sightings, in their sigmas squared
  double scatter = 1;   // of stretches of time, which the covariance has been multiplied by
  LightStage stage = LightStage::kAll;  // kWand: the rig has the unit of the wand
};

// `cameras` are checked. Errors are those of reconstruct() and upgrade(); kDegenerate too where the
// result leaves a focal length or a place open, kCancelled where a stop was requested.
[[nodiscard]] Result<LightFit> fit_light(const std::vector<LightCamera>& cameras,
                                         const LightOptions& options, const std::stop_token& stop);

}  // namespace calvin::rig
