// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigid motions of space. Named a_from_b: it takes coordinates in frame b to frame a.
#pragma once

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/core/export.hpp"

namespace calvin {

struct SE3 {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  // In plain numbers, since most files include this one: an expression of Eigen takes each of them
  // longer to compile than all of the header.
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    const double* r = rotation.data();  // column by column
    const double* p = point.data();
    const double* t = translation.data();
    return {r[0] * p[0] + r[3] * p[1] + r[6] * p[2] + t[0],
            r[1] * p[0] + r[4] * p[1] + r[7] * p[2] + t[1],
            r[2] * p[0] + r[5] * p[1] + r[8] * p[2] + t[2]};
  }
  [[nodiscard]] CALVIN_API SE3 operator*(const SE3& other) const;
  [[nodiscard]] CALVIN_API SE3 inverse() const;
};

// Rotation by |w| rad about w (Rodrigues), and its inverse with |w| in 0..pi.
[[nodiscard]] CALVIN_API Eigen::Matrix3d exp_so3(const Eigen::Vector3d& w);
[[nodiscard]] CALVIN_API Eigen::Vector3d log_so3(const Eigen::Matrix3d& rotation);

// The shortest rotation that takes the direction `from` to the direction `to`; neither is zero.
[[nodiscard]] CALVIN_API Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from,
                                                          const Eigen::Vector3d& to);

// The rotation closest to `m` in the Frobenius norm (Umeyama's sign: determinant +1). NaN
// all over where a number of `m` is not finite.
[[nodiscard]] CALVIN_API Eigen::Matrix3d closest_rotation(const Eigen::Matrix3d& m);

// Rigid motion as plain numbers (a file, a message) and back.
[[nodiscard]] CALVIN_API SE3 to_se3(const Pose& pose);
[[nodiscard]] CALVIN_API Pose to_pose(const SE3& motion);

}  // namespace calvin
