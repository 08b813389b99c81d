// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The exponential and the logarithm of rotations, the closest rotation to a matrix, and the poses
// that files hold.

#include "calvin/geometry/se3.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace calvin {

SE3 SE3::operator*(const SE3& other) const {
  return {rotation * other.rotation, rotation * other.translation + translation};
}

SE3 SE3::inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }

Eigen::Matrix3d exp_so3(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Eigen::Vector3d log_so3(const Eigen::Matrix3d& rotation) {
  // By way of the quaternion: exact to rounding at 0 and at pi alike.
  const Eigen::Quaterniond q(rotation);
  const Eigen::Vector3d axis = q.w() < 0 ? Eigen::Vector3d(-q.vec()) : Eigen::Vector3d(q.vec());
  const double sine = axis.norm();
  if (sine < 1e-300) return Eigen::Vector3d::Zero();
  return axis * (2 * std::atan2(sine, std::abs(q.w())) / sine);
}

Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized();
  const Eigen::Vector3d b = to.normalized();
  Eigen::Vector3d axis = a.cross(b);
  const double sine = axis.norm();
  // Opposite directions: half a turn about any axis across them.
  if (sine < 1e-12 && a.dot(b) < 0) return exp_so3(std::numbers::pi * a.unitOrthogonal());
  if (sine > 0) axis /= sine;
  return exp_so3(axis * std::atan2(sine, a.dot(b)));
}

Eigen::Matrix3d closest_rotation(const Eigen::Matrix3d& m) {
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  if (!m.allFinite()) return Eigen::Matrix3d::Constant(kNoNumber);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign[2] = -1;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

SE3 to_se3(const Pose& pose) {
  return {exp_so3(Eigen::Vector3d(pose.rotation.data())), Eigen::Vector3d(pose.translation.data())};
}

Pose to_pose(const SE3& motion) {
  const Eigen::Vector3d w = log_so3(motion.rotation);
  const Eigen::Vector3d& t = motion.translation;
  return {{w[0], w[1], w[2]}, {t[0], t[1], t[2]}};
}

}  // namespace calvin
