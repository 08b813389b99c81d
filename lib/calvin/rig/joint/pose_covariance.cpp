// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The covariance of a pose by differences of where corners are expected.

#include "calvin/rig/joint/pose_covariance.hpp"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "calvin/rig/pose_unknowns.hpp"

namespace calvin::rig {

namespace {

// Where a camera expects the corners in use, weighted: u v u v ...
Eigen::VectorXd expected(const PointSet& seen, const Camera& camera, const SE3& pose) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(seen.size()));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto at = camera.project(pose * seen.points[i]);
    if (!at || !(seen.weight[i] > 0)) continue;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    all(row) = seen.weight[i] * at->u;
    all(row + 1) = seen.weight[i] * at->v;
  }
  return all;
}

// board_from_camera turned about the axes of the board, and moved.
SE3 moved(const SE3& camera_from_board, const Eigen::Matrix<double, kPose, 1>& by) {
  const SE3 board_from_camera = camera_from_board.inverse();
  return SE3{exp_so3(by.head<3>()) * board_from_camera.rotation,
             board_from_camera.translation + by.tail<3>()}
      .inverse();
}

Eigen::MatrixXd by_pose(const PointSet& seen, const Camera& camera, const SE3& pose) {
  constexpr double kStep = 1e-6;  // rad, and of the distance
  Eigen::MatrixXd jacobian(2 * static_cast<Eigen::Index>(seen.size()), kPose);
  const double away = pose.translation.norm();
  for (int k = 0; k < kPose; ++k) {
    Eigen::Matrix<double, kPose, 1> step = Eigen::Matrix<double, kPose, 1>::Zero();
    step(k) = k < 3 ? kStep : kStep * away;
    jacobian.col(k) =
        (expected(seen, camera, moved(pose, step)) - expected(seen, camera, moved(pose, -step))) /
        (2 * step(k));
  }
  return jacobian;
}

// Over the parameters that have a sigma; no columns where their covariance is not known.
Eigen::MatrixXd by_intrinsics(const PointSet& seen, const Calibration& calibration,
                              const SE3& pose) {
  constexpr double kStep = 1e-4;  // sigmas
  std::vector<Eigen::VectorXd> columns;
  for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
    if (!calibration.parameters[i].sigma) continue;
    const double step = std::max(kStep * *calibration.parameters[i].sigma, 1e-12);
    const auto at = [&](double by) {
      Calibration other = calibration;
      other.parameters[i].value += by;
      const auto camera = Camera::make(other);
      return camera ? expected(seen, *camera, pose) : Eigen::VectorXd();
    };
    const Eigen::VectorXd ahead = at(step);
    const Eigen::VectorXd behind = at(-step);
    if (ahead.size() == 0 || behind.size() == 0) return {};
    columns.emplace_back((ahead - behind) / (2 * step));
  }
  if (calibration.covariance.size() != columns.size() * columns.size()) return {};
  Eigen::MatrixXd jacobian(2 * static_cast<Eigen::Index>(seen.size()),
                           static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    jacobian.col(static_cast<Eigen::Index>(i)) = columns[i];
  }
  return jacobian;
}

}  // namespace

PoseCovariance pose_covariance(const PointSet& seen, const Calibration& calibration,
                               const Camera& camera, const SE3& camera_from_board,
                               double variance) {
  PoseCovariance covariance;
  const Eigen::MatrixXd jacobian = by_pose(seen, camera, camera_from_board);
  const Eigen::Matrix<double, kPose, kPose> information = jacobian.transpose() * jacobian;
  const Eigen::LDLT<Eigen::Matrix<double, kPose, kPose>> factors(information);
  covariance.of_noise = variance * factors.solve(Eigen::MatrixXd::Identity(kPose, kPose));
  covariance.of_lens.setZero();
  const Eigen::MatrixXd of_lens = by_intrinsics(seen, calibration, camera_from_board);
  if (of_lens.cols() > 0) {
    const Eigen::MatrixXd moves = factors.solve(jacobian.transpose() * of_lens);
    const Eigen::Map<const Eigen::MatrixXd> lens(calibration.covariance.data(), of_lens.cols(),
                                                 of_lens.cols());
    covariance.of_lens = moves * lens * moves.transpose();
  }
  return covariance;
}

}  // namespace calvin::rig
