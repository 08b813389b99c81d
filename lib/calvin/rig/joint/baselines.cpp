// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The places of a solved rig are a normal distribution for boards of a unit size. They are
// conditioned on the distances, linearised anew until nothing changes (the iterated Kalman update,
// which is Gauss-Newton of that least squares: B. Bell, F. Cathey, IEEE Trans. Automatic Control
// 38(2), 1993).

#include "calvin/rig/joint/baselines.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "calvin/rig/pose_unknowns.hpp"

namespace calvin::rig {

namespace {

Eigen::Index place_of(std::size_t camera) { return kPose * static_cast<Eigen::Index>(camera) + 3; }

// Of the distances by the change of turns and places, and of the scale at the end.
struct Linearised {
  Eigen::VectorXd distances;
  Eigen::MatrixXd by;
};

Linearised linearise(const PlacedCameras& cameras, const std::vector<KnownDistance>& known,
                     const Eigen::VectorXd& change) {
  const auto rows = static_cast<Eigen::Index>(known.size());
  const Eigen::Index last = change.size() - 1;
  const double scale = 1 + change(last);
  Linearised all = {Eigen::VectorXd(rows), Eigen::MatrixXd::Zero(rows, change.size())};
  for (Eigen::Index row = 0; row < rows; ++row) {
    const KnownDistance& one = known[static_cast<std::size_t>(row)];
    const auto at = [&](std::size_t camera) -> Eigen::Vector3d {
      return cameras.rig_from_camera[camera].translation + change.segment<3>(place_of(camera));
    };
    const Eigen::Vector3d between = at(one.b) - at(one.a);
    const double length = between.norm();
    const Eigen::Vector3d along =
        length > 0 ? Eigen::Vector3d(between / length) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
    all.distances(row) = scale * length;
    all.by.block<1, 3>(row, place_of(one.b)) += scale * along.transpose();
    all.by.block<1, 3>(row, place_of(one.a)) -= scale * along.transpose();
    all.by(row, last) = length;
  }
  return all;
}

// Turns, places and the scale that the change leads to.
ScaledCameras moved(const PlacedCameras& cameras, const Eigen::VectorXd& change,
                    const Eigen::MatrixXd& covariance) {
  const Eigen::Index last = change.size() - 1;
  ScaledCameras result;
  result.scale = 1 + change(last);
  result.sigma = std::sqrt(std::max(covariance(last, last), 0.0));
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(last, last + 1);
  for (std::size_t c = 0; c < cameras.rig_from_camera.size(); ++c) {
    const SE3& pose = cameras.rig_from_camera[c];
    const Eigen::Index at = place_of(c);
    const Eigen::Vector3d place = pose.translation + change.segment<3>(at);
    result.cameras.rig_from_camera.push_back(
        {exp_so3(change.segment<3>(at - 3)) * pose.rotation, result.scale * place});
    by.block<3, 3>(at - 3, at - 3).setIdentity();
    by.block<3, 3>(at, at) = result.scale * Eigen::Matrix3d::Identity();
    by.block<3, 1>(at, last) = place;
  }
  result.cameras.covariance = by * covariance * by.transpose();
  return result;
}

}  // namespace

std::optional<ScaledCameras> scale_by(const PlacedCameras& cameras,
                                      const std::vector<KnownDistance>& distances,
                                      double board_sigma) {
  constexpr int kMostSteps = 50;
  constexpr double kNothing = 1e-12;  // m, rad
  const Eigen::Index count = cameras.covariance.rows() + 1;
  const auto rows = static_cast<Eigen::Index>(distances.size());
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(count, count);
  prior.topLeftCorner(count - 1, count - 1) = cameras.covariance;
  prior(count - 1, count - 1) = board_sigma * board_sigma;
  Eigen::VectorXd known(rows);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(rows, rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const KnownDistance& one = distances[static_cast<std::size_t>(row)];
    known(row) = one.distance;
    noise(row, row) = one.sigma * one.sigma;
  }
  Eigen::VectorXd change = Eigen::VectorXd::Zero(count);
  std::vector<double> misses;
  Eigen::MatrixXd gain;
  Eigen::MatrixXd by;
  for (int step = 0; step < kMostSteps; ++step) {
    const Linearised now = linearise(cameras, distances, change);
    const Eigen::MatrixXd expected = now.by * prior * now.by.transpose() + noise;
    const Eigen::LLT<Eigen::MatrixXd> factor(expected);
    if (factor.info() != Eigen::Success) return std::nullopt;
    for (Eigen::Index row = 0; step == 0 && row < rows; ++row) {
      misses.push_back((known(row) - now.distances(row)) / std::sqrt(expected(row, row)));
    }
    by = now.by;
    gain = factor.solve(now.by * prior).transpose();
    const Eigen::VectorXd next = gain * (known - now.distances + now.by * change);
    const double moved_by = (next - change).cwiseAbs().maxCoeff();
    change = next;
    if (moved_by < kNothing) break;
  }
  if (!change.allFinite() || !(1 + change(count - 1) > 0)) return std::nullopt;
  // Joseph's form, which stays positive.
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(count, count) - gain * by;
  const Eigen::MatrixXd covariance =
      rest * prior * rest.transpose() + gain * noise * gain.transpose();
  ScaledCameras result = moved(cameras, change, covariance);
  result.misses = std::move(misses);
  return result;
}

}  // namespace calvin::rig
