// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A camera on the hand of a robot, solved by Ceres with other unknowns than solve_hand_eye() has:
// hand_from_camera, base_from_board and every base_from_hand.
#pragma once

#include <array>
#include <cmath>
#include <deque>
#include <vector>

#include "calvin/rig/hand_eye/loop.hpp"
#include "calvin/rig/rig_views.hpp"
#include "ceres_formulas.hpp"

namespace calvin::formulas {

using PoseNumbers = std::array<double, 6>;
inline PoseNumbers to_numbers(const SE3& pose) {
  const Eigen::Vector3d w = log_so3(pose.rotation);
  const Eigen::Vector3d& t = pose.translation;
  return {w[0], w[1], w[2], t[0], t[1], t[2]};
}
inline SE3 from_numbers(const PoseNumbers& n) {
  return {exp_so3({n[0], n[1], n[2]}), {n[3], n[4], n[5]}};
}

template <typename T>
void apply(const T* pose, const T* point, T* to) {
  ceres::AngleAxisRotatePoint(pose, point, to);
  for (int k = 0; k < 3; ++k) to[k] += pose[3 + k];
}
template <typename T>
void apply_inverse(const T* pose, const T* point, T* to) {
  const T back[3] = {-pose[0], -pose[1], -pose[2]};
  const T from[3] = {point[0] - pose[3], point[1] - pose[4], point[2] - pose[5]};
  ceres::AngleAxisRotatePoint(back, from, to);
}

// A corner through board, base, hand and camera.
struct SeenByHand {
  std::array<double, 8> camera;  // of brown4
  Eigen::Vector3d printed;
  Pixel at;
  double sigma;  // px

  template <typename T>
  bool operator()(const T* hand_from_camera, const T* base_from_board, const T* base_from_hand,
                  T* out) const {
    const T on_board[3] = {T(printed.x()), T(printed.y()), T(printed.z())};
    T in_base[3];
    T in_hand[3];
    T p[3];
    apply(base_from_board, on_board, in_base);
    apply_inverse(base_from_hand, in_base, in_hand);
    apply_inverse(hand_from_camera, in_hand, p);
    T lens[4];
    for (std::size_t k = 0; k < 4; ++k) lens[k] = T(camera[4 + k]);
    T xy[2];
    if (!Brown4::distort(lens, p, xy)) return false;
    out[0] = (camera[0] * xy[0] + camera[2] - at.u) / sigma;
    out[1] = (camera[1] * xy[1] + camera[3] - at.v) / sigma;
    return true;
  }
};

// What the robot told of its hand.
struct ToldByRobot {
  PoseNumbers told;
  double turn_sigma;
  double place_sigma;

  template <typename T>
  bool operator()(const T* base_from_hand, T* out) const {
    T q[4];
    ceres::AngleAxisToQuaternion(base_from_hand, q);
    const T back[3] = {T(-told[0]), T(-told[1]), T(-told[2])};
    T inverse[4];
    T between[4];
    ceres::AngleAxisToQuaternion(back, inverse);
    ceres::QuaternionProduct(q, inverse, between);
    ceres::QuaternionToAngleAxis(between, out);
    for (int k = 0; k < 3; ++k) {
      out[k] /= turn_sigma;
      out[3 + k] = (base_from_hand[3 + k] - told[static_cast<std::size_t>(3 + k)]) / place_sigma;
    }
    return true;
  }
};

struct RobotSigmas {
  double corner = 1;  // px
  double turn = 0;    // rad; 0: the poses are exact
  double place = 0;   // m
};

// From places near the optimum.
inline rig::HandEyePlaces solve_by_ceres(const RigCameraViews& seen,
                                         const std::vector<Pose>& base_from_hand,
                                         const RobotSigmas& sigmas,
                                         const rig::HandEyePlaces& start) {
  PoseNumbers camera = to_numbers(start.mount_from_camera);
  PoseNumbers board = to_numbers(start.carrier_from_board);
  std::deque<PoseNumbers> hands;
  ceres::Problem problem;
  std::array<double, 8> lens{};
  for (std::size_t i = 0; i < lens.size(); ++i) lens[i] = seen.calibration.parameters[i].value;
  for (std::size_t v = 0; v < seen.views.size(); ++v) {
    const auto& [observation, on] = seen.views[v];
    hands.push_back(to_numbers(to_se3(base_from_hand[v])));
    double* hand = hands.back().data();
    for (std::size_t i = 0; i < observation.ids.size(); ++i) {
      const Eigen::Vector3d point = on.points()[static_cast<std::size_t>(observation.ids[i])];
      const double sigma = sigmas.corner * observation.sigma[i];
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SeenByHand, 2, 6, 6, 6>(
                                   new SeenByHand{lens, point, observation.uv[i], sigma}),
                               nullptr, camera.data(), board.data(), hand);
    }
    if (sigmas.turn > 0) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ToldByRobot, 6, 6>(
                                   new ToldByRobot{hands.back(), sigmas.turn, sigmas.place}),
                               nullptr, hand);
    } else {
      problem.SetParameterBlockConstant(hand);
    }
  }
  ceres::Solver::Summary summary;
  ceres::Solve(settled(ceres::DENSE_QR), &problem, &summary);
  return {from_numbers(camera), from_numbers(board), 1};
}

}  // namespace calvin::formulas
