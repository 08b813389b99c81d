// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras on the hand of a robot and a board of unknown size, solved by Ceres with other unknowns
// than solve_strobl() has: the cameras on the hand by themselves, every base_from_hand, and pitch
// and aspect as factors of the points.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "calvin/rig/strobl/solve_strobl.hpp"
#include "ceres_hand_eye.hpp"

namespace calvin::formulas {

// A corner through board, base and hand to a camera of brown4.
struct SeenBySheet {
  Eigen::Vector3d printed;
  Pixel at;
  double sigma;  // px

  template <typename T>
  bool operator()(const T* camera, const T* hand_from_camera, const T* base_from_board,
                  const T* base_from_hand, const T* sheet, T* out) const {
    const T on_board[3] = {sheet[0] * printed.x(), sheet[0] * sheet[1] * printed.y(),
                           sheet[0] * printed.z()};
    T in_base[3];
    T in_hand[3];
    T p[3];
    apply(base_from_board, on_board, in_base);
    apply_inverse(base_from_hand, in_base, in_hand);
    apply_inverse(hand_from_camera, in_hand, p);
    T xy[2];
    if (!Brown4::distort(camera + 4, p, xy)) return false;
    out[0] = (camera[0] * xy[0] + camera[2] - at.u) / sigma;
    out[1] = (camera[1] * xy[1] + camera[3] - at.v) / sigma;
    return true;
  }
};

struct CeresStrobl {
  struct OneCamera {
    std::array<double, 8> intrinsics{};
    PoseNumbers hand_from_camera{};
  };
  std::vector<OneCamera> cameras;
  PoseNumbers base_from_board{};
  std::array<double, 2> sheet = {1, 1};  // scale and aspect
  std::array<double, 2> sheet_sigma{};
  std::vector<std::array<double, 8>> intrinsics_sigma;  // of each camera
  double cost = 0;
};

// From numbers near the optimum; `at` has them, and takes the result.
inline bool solve_strobl_by_ceres(const std::vector<RobotCamera>& seen,
                                  const std::vector<Pose>& base_from_hand,
                                  const RobotSigmas& sigmas, CeresStrobl& at) {
  std::map<std::size_t, PoseNumbers> hands;
  ceres::Problem problem;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    for (std::size_t v = 0; v < seen[c].seen.views.size(); ++v) {
      const auto& [observation, on] = seen[c].seen.views[v];
      const std::size_t pose = seen[c].pose_of_view[v];
      PoseNumbers& hand =
          hands.try_emplace(pose, to_numbers(to_se3(base_from_hand[pose]))).first->second;
      for (std::size_t i = 0; i < observation.ids.size(); ++i) {
        const Eigen::Vector3d point = on.points()[static_cast<std::size_t>(observation.ids[i])];
        const double sigma = sigmas.corner * observation.sigma[i];
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SeenBySheet, 2, 8, 6, 6, 6, 2>(
                                     new SeenBySheet{point, observation.uv[i], sigma}),
                                 nullptr, at.cameras[c].intrinsics.data(),
                                 at.cameras[c].hand_from_camera.data(), at.base_from_board.data(),
                                 hand.data(), at.sheet.data());
      }
    }
  }
  for (auto& [pose, hand] : hands) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ToldByRobot, 6, 6>(
                                 new ToldByRobot{hand, sigmas.turn, sigmas.place}),
                             nullptr, hand.data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(settled(ceres::DENSE_SCHUR), &problem, &summary);
  at.cost = summary.final_cost;
  ceres::Covariance::Options how;
  how.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(how);
  std::vector<std::pair<const double*, const double*>> blocks = {
      {at.sheet.data(), at.sheet.data()}};
  for (const auto& camera : at.cameras) {
    blocks.emplace_back(camera.intrinsics.data(), camera.intrinsics.data());
  }
  if (!covariance.Compute(blocks, &problem)) return false;
  double of_sheet[4];
  covariance.GetCovarianceBlock(at.sheet.data(), at.sheet.data(), of_sheet);
  at.sheet_sigma = {std::sqrt(of_sheet[0]), std::sqrt(of_sheet[3])};
  for (const auto& camera : at.cameras) {
    double all[64];
    covariance.GetCovarianceBlock(camera.intrinsics.data(), camera.intrinsics.data(), all);
    std::array<double, 8>& sigma = at.intrinsics_sigma.emplace_back();
    for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] = std::sqrt(all[9 * i]);
  }
  return true;
}

}  // namespace calvin::formulas
