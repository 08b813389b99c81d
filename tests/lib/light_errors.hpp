// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far cameras that a light has calibrated are from the truth, in what is said of their errors.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "calvin/rig/solve_light.hpp"
#include "simulated_light.hpp"

namespace calvin::scenes {

// The errors of all numbers of a solution, in the order of its names, where its frame is
// `world_from_room`: that of the room itself where places of cameras were known.
inline Eigen::VectorXd errors_of(const LightSolution& solved, const LitRoom& room,
                                 const SE3& world_from_room = {}) {
  Eigen::VectorXd errors(static_cast<Eigen::Index>(solved.names.size()));
  Eigen::Index at = 0;
  for (std::size_t c = 0; c < room.cameras.size(); ++c) {
    const RigCamera& camera = solved.rig.cameras[c];
    const auto& truth = room.cameras[c].parameters();
    for (std::size_t p = 0; p < truth.size(); ++p) {
      const Parameter& found = camera.calibration.parameters[p];
      if (found.sigma) errors[at++] = found.value - truth[p];
    }
    const SE3 pose = to_se3(camera.rig_from_camera);
    const SE3 true_pose = world_from_room * room.room_from_camera[c];
    errors.segment<3>(at) = log_so3(pose.rotation * true_pose.rotation.transpose());
    errors.segment<3>(at + 3) = pose.translation - true_pose.translation;
    at += 6;
  }
  return errors;
}

struct Normalised {
  double square = 0;  // e^T C^-1 e
  double degrees = 0;
  double largest = 0;  // component, in its sigma
};

// Directions that the similarity has taken out have no variance, and do not count.
inline Normalised normalised(const LightSolution& solved, const Eigen::VectorXd& errors) {
  const Eigen::Index n = errors.size();
  const Eigen::Map<const Eigen::MatrixXd> covariance(solved.covariance.data(), n, n);
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  // The camera that is the frame has no error.
  const Eigen::VectorXd scale = sigma.unaryExpr([](double s) { return s > 0 ? 1 / s : 0; });
  const Eigen::VectorXd z = errors.cwiseProduct(scale);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * covariance *
                                                             scale.asDiagonal());
  Normalised result;
  result.largest = z.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) {
    constexpr double kNone = 1e-9;
    if (!(eigen.eigenvalues()[i] > kNone)) continue;
    const double along = eigen.eigenvectors().col(i).dot(z);
    result.square += along * along / eigen.eigenvalues()[i];
    result.degrees += 1;
  }
  return result;
}

}  // namespace calvin::scenes
