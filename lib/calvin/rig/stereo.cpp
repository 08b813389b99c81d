// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The turns that rectify a stereo pair.

#include "calvin/rig/stereo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "calvin/geometry/se3.hpp"

namespace calvin {

namespace {

tl::unexpected<Error> no_pair(const Rig& rig, const char* why) {
  return make_error(ErrorCode::kDegenerate, fmt::format("'{}' and '{}' are no stereo pair: {}",
                                                        rig.cameras[0].calibration.camera,
                                                        rig.cameras[1].calibration.camera, why));
}

// Whether the rectified camera still looks where the camera did, to 75 degrees: a rectified picture
// shows no more.
bool looks_ahead(const Eigen::Matrix3d& camera_from_rectified) {
  constexpr double kMost = 75 * std::numbers::pi / 180;
  return camera_from_rectified(2, 2) > std::cos(kMost);
}

}  // namespace

Result<StereoPair> stereo_pair(const Rig& rig) {
  constexpr double kNearest = 1e-6;  // m
  if (rig.cameras.size() != 2) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("Rectification takes a rig of two cameras, and this one has {}: "
                                  "give calvin-rig the two of the pair alone.",
                                  rig.cameras.size()));
  }
  SE3 first = to_se3(rig.cameras[0].rig_from_camera);
  SE3 second = to_se3(rig.cameras[1].rig_from_camera);
  const Eigen::Vector3d half = 0.5 * log_so3(first.rotation.transpose() * second.rotation);
  // The axes that both are turned to meet in.
  const Eigen::Matrix3d rig_from_mean = first.rotation * exp_so3(half);
  Eigen::Vector3d baseline = rig_from_mean.transpose() * (second.translation - first.translation);
  StereoPair pair;
  pair.baseline = baseline.norm();
  if (!(pair.baseline > kNearest)) return no_pair(rig, "they stand in one place.");
  pair.is_vertical = std::abs(baseline.y()) > std::abs(baseline.x());
  const int axis = pair.is_vertical ? 1 : 0;
  if (std::abs(baseline.z()) > std::abs(baseline[axis])) {
    return no_pair(rig, "one stands before the other.");
  }
  if (baseline[axis] < 0) {
    std::swap(pair.left, pair.right);
    std::swap(first, second);
    baseline = -baseline;
  }
  const Eigen::Matrix3d rig_from_rectified =
      rig_from_mean * rotation_between(Eigen::Vector3d::Unit(axis), baseline.normalized());
  pair.left_from_rectified = first.rotation.transpose() * rig_from_rectified;
  pair.right_from_rectified = second.rotation.transpose() * rig_from_rectified;
  if (!looks_ahead(pair.left_from_rectified) || !looks_ahead(pair.right_from_rectified)) {
    return no_pair(rig, "they look in different directions.");
  }
  return pair;
}

namespace rig {

std::optional<double> epipolar_error(const std::vector<CommonCorner>& corners, const SE3& b_from_a,
                                     double focal) {
  if (corners.empty() || !(b_from_a.translation.norm() > 0)) return std::nullopt;
  double squares = 0;
  std::size_t count = 0;
  for (const CommonCorner& corner : corners) {
    const Eigen::Vector3d normal =
        b_from_a.translation.cross(b_from_a.rotation * corner.ray_a).normalized();
    if (!(normal.squaredNorm() > 0)) continue;  // the ray leads to the other camera
    const double sine = std::clamp(normal.dot(corner.ray_b.normalized()), -1.0, 1.0);
    const double off = focal * std::asin(sine);
    squares += off * off;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(squares / static_cast<double>(count));
}

}  // namespace rig

}  // namespace calvin
