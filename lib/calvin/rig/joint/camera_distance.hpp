// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far two cameras of a rig are apart, and how well that is known. Internal.
#pragma once

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"

namespace calvin::rig {

struct CameraDistance {
  double distance = 0;  // m
  double sigma = 0;     // m
  double angle = 0;     // rad, between the optical axes
};

// `covariance`: m^2, of the place of the first camera in the rig, then of that of the second.
[[nodiscard]] CameraDistance camera_distance(const SE3& rig_from_a, const SE3& rig_from_b,
                                             const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace calvin::rig
