// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the pose of a board from one camera to the other by the rig, with its covariance.

#include "calvin/rig/watch/discrepancy.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "calvin/geometry/cross_matrix.hpp"
#include "calvin/solve/start/pose_fit.hpp"

namespace calvin::rig {

namespace {

Matrix6 covariance_of(const RigCamera& camera) {
  if (camera.covariance.size() != 36) return Matrix6::Zero();  // the camera that is the rig
  return Eigen::Map<const Matrix6>(camera.covariance.data());
}

Matrix6 turned(const Eigen::Matrix3d& turn, const Eigen::Matrix3d& place_by_turn,
               const Eigen::Matrix3d& place, const Matrix6& covariance) {
  Matrix6 jacobian = Matrix6::Zero();
  jacobian.topLeftCorner<3, 3>() = turn;
  jacobian.bottomLeftCorner<3, 3>() = place_by_turn;
  jacobian.bottomRightCorner<3, 3>() = place;
  return jacobian * covariance * jacobian.transpose();
}

// For one tilt of each view and one labelling, which is first_from_second of the frames of the
// board.
Discrepancy discrepancy_of(const RigCamera& first, const MeasuredPose::Choice& by_first,
                           const RigCamera& second, const MeasuredPose::Choice& by_second,
                           const SE3& labelling) {
  const SE3 rig_from_first = to_se3(first.rig_from_camera);
  const SE3 known = to_se3(second.rig_from_camera);
  const SE3 first_from_board = by_first.camera_from_board;
  const SE3 board_from_second = labelling * by_second.camera_from_board.inverse();
  const SE3 seen = rig_from_first * first_from_board * board_from_second;
  Discrepancy result;
  result.change << log_so3(seen.rotation * known.rotation.transpose()),
      seen.translation - known.translation;
  // A turn w and a step s of the second camera on the board are R w and R s in the rig. Those of
  // the first one turn the board and all that stands on it the other way about that camera.
  const Eigen::Matrix3d of_first = (rig_from_first * first_from_board).rotation;
  const Eigen::Matrix3d of_second = of_first * labelling.rotation;
  const Eigen::Vector3d between =
      board_from_second.translation - first_from_board.inverse().translation;
  const auto by_both = [&](const Matrix6& a, const Matrix6& b) -> Matrix6 {
    return turned(-of_first, of_first * cross_matrix(between), -of_first, a) +
           turned(of_second, Eigen::Matrix3d::Zero(), of_second, b);
  };
  result.of_noise = by_both(by_first.covariance.of_noise, by_second.covariance.of_noise);
  result.in_common = by_both(by_first.covariance.of_lens, by_second.covariance.of_lens);
  // The rig turns about its first camera's place likewise.
  const Eigen::Matrix3d lever = -cross_matrix(seen.translation - rig_from_first.translation);
  result.in_common += turned(Eigen::Matrix3d::Identity(), lever, Eigen::Matrix3d::Identity(),
                             covariance_of(first)) +
                      covariance_of(second);
  return result;
}

}  // namespace

MeasuredPose measure_pose(const BoardView& view, const Calibration& calibration,
                          const Camera& camera) {
  constexpr double kRotations = 1e-3;  // between tilts that are two
  MeasuredPose measured;
  measured.labellings = view.labellings;
  const auto fit = fit_pose(view.seen, camera, Loss{});
  if (!fit) return measured;
  const double free = std::max(2 * static_cast<double>(view.seen.used()) - 6, 1.0);
  const double told = view.seen.sigma_known ? view.sigma * view.sigma : 0;
  const auto add = [&](const SE3& pose, double cost) {
    const double variance = std::max(told, cost / free);
    measured.choices.push_back(
        {pose, pose_covariance(view.seen, calibration, camera, pose, variance)});
  };
  add(fit->camera_from_board, fit->cost);
  const bool is_other = (fit->other.rotation - fit->camera_from_board.rotation).norm() > kRotations;
  if (view.poses.size() > 1 && is_other) add(fit->other, fit->other_cost);
  return measured;
}

double normalised_square(const Vector6& change, const Matrix6& covariance) {
  const double square = change.dot(covariance.ldlt().solve(change)) / 6;
  return std::isfinite(square) ? std::max(square, 0.0) : 0;
}

double Discrepancy::square() const { return normalised_square(change, of_noise + in_common); }

std::optional<Discrepancy> discrepancy(const RigCamera& first, const MeasuredPose& by_first,
                                       const RigCamera& second, const MeasuredPose& by_second) {
  std::optional<Discrepancy> least;
  double square = 0;
  for (const auto& a : by_first.choices) {
    for (const auto& b : by_second.choices) {
      for (const SE3& of_first : by_first.labellings) {
        for (const SE3& of_second : by_second.labellings) {
          const Discrepancy one =
              discrepancy_of(first, a, second, b, of_first.inverse() * of_second);
          const double now = one.square();
          if (least && now >= square) continue;
          least = one;
          square = now;
        }
      }
    }
  }
  return least;
}

}  // namespace calvin::rig
