// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a solve of a rig says of its cameras. Internal.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calvin/core/rig.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/rig_views.hpp"

namespace calvin::rig {

// Of the turns and places of all cameras in the frame of the rig, from that of retract() on
// camera_from_rig of all but the first camera, which has zeros.
[[nodiscard]] Eigen::MatrixXd in_rig_frame(const Eigen::MatrixXd& covariance,
                                           const std::vector<SE3>& camera_from_rig);

// Poses and covariances of all cameras, `covariance` over their turns and places; `rms` in px.
void set_cameras(const std::vector<Calibration>& cameras, const std::vector<SE3>& camera_from_rig,
                 const Eigen::MatrixXd& covariance, const std::vector<double>& rms, Rig& to);

}  // namespace calvin::rig
