// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Two cameras as a stereo pair: how each is turned so that what both see lies in one row, and how
// far corners are from that.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/common_corners.hpp"

namespace calvin {

// The axes of both rectified cameras are parallel. Along x, or along y where `is_vertical`, the
// left (or upper) camera comes before the right (or lower) one.
struct StereoPair {
  std::size_t left = 0;  // cameras of the rig
  std::size_t right = 1;
  bool is_vertical = false;
  double baseline = 0;  // m, between the cameras
  Eigen::Matrix3d left_from_rectified = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d right_from_rectified = Eigen::Matrix3d::Identity();
};

// Each camera is turned by half of the rotation between the two, then both so that the baseline is
// an axis (J.-Y. Bouguet, Camera Calibration Toolbox; OpenCV's stereoRectify()).
// kInvalidArgument for a rig that has not two cameras; kDegenerate for two that no rectification
// serves: in one place, one before the other, or looking in different directions.
[[nodiscard]] Result<StereoPair> stereo_pair(const Rig& rig);

namespace rig {

// The root mean square of how far rays of the second camera pass by the planes through both cameras
// and the rays of the first, px by the mean of the focal lengths: in rectified pictures of that
// focal length, how far corners are from the rows of each other. Absent without corners, or
// without a distance between the cameras.
[[nodiscard]] std::optional<double> epipolar_error(const std::vector<CommonCorner>& corners,
                                                   const SE3& b_from_a, double focal);

}  // namespace rig

}  // namespace calvin
