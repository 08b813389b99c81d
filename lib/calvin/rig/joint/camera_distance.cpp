// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The distance by the derivatives along the line between the cameras.

#include "calvin/rig/joint/camera_distance.hpp"

#include <algorithm>
#include <cmath>

namespace calvin::rig {

CameraDistance camera_distance(const SE3& rig_from_a, const SE3& rig_from_b,
                               const Eigen::Matrix<double, 6, 6>& covariance) {
  CameraDistance result;
  const double cosine = rig_from_a.rotation.col(2).dot(rig_from_b.rotation.col(2));
  result.angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  const Eigen::Vector3d between = rig_from_b.translation - rig_from_a.translation;
  result.distance = between.norm();
  if (!(result.distance > 0)) return result;
  Eigen::Matrix<double, 6, 1> by;
  by << -between / result.distance, between / result.distance;
  result.sigma = std::sqrt(std::max(by.dot(covariance * by), 0.0));
  return result;
}

}  // namespace calvin::rig
