// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames and cameras of a result.

#include "calvin/rig/result/rig_result.hpp"

#include <utility>

#include "calvin/geometry/dense.hpp"

namespace calvin::rig {

namespace {

constexpr Eigen::Index kPose = 6;

}  // namespace

// For R = exp(d) R0 and t = exp(d) t0 + e the camera stands at -R^T t, so that both move by -R0^T
// of d and e.
Eigen::MatrixXd in_rig_frame(const Eigen::MatrixXd& covariance,
                             const std::vector<SE3>& camera_from_rig) {
  const auto count = kPose * static_cast<Eigen::Index>(camera_from_rig.size());
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(count, count - kPose);
  for (std::size_t c = 1; c < camera_from_rig.size(); ++c) {
    const auto at = kPose * static_cast<Eigen::Index>(c);
    const Eigen::Matrix3d back = -camera_from_rig[c].rotation.transpose();
    turn.block<3, 3>(at, at - kPose) = back;
    turn.block<3, 3>(at + 3, at - kPose + 3) = back;
  }
  return congruent(covariance, turn.transpose());
}

void set_cameras(const std::vector<Calibration>& cameras, const std::vector<SE3>& camera_from_rig,
                 const Eigen::MatrixXd& covariance, const std::vector<double>& rms, Rig& to) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    RigCamera camera;
    camera.calibration = cameras[c];
    camera.rig_from_camera = to_pose(camera_from_rig[c].inverse());
    for (double& x : camera.rig_from_camera.translation) x += 0.0;  // no -0 of the first camera
    camera.rms = rms[c];
    const auto at = kPose * static_cast<Eigen::Index>(c);
    const Eigen::MatrixXd own = covariance.block(at, at, kPose, kPose);
    if (!own.isZero(0)) camera.covariance = row_major(own);
    to.cameras.push_back(std::move(camera));
  }
}

}  // namespace calvin::rig
