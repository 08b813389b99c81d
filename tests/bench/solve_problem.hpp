// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What bench_solve gives to everybody: the same corners, and one measure of what comes back.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "scenes.hpp"

namespace bench {

using calvin::SE3;

// A side of 1/32 m and corners rounded to floats: OpenCV takes floats, and all solve the same.
inline const calvin::Board kBoard = calvin::Checkerboard{9, 6, 0.03125};
inline constexpr calvin::ImageSize kSize = calvin::scenes::kSize;
inline constexpr double kSigma = 0.1;  // px

struct Fitted {
  std::vector<double> intrinsics;      // fx fy cx cy and the coefficients, in the model's order
  std::vector<SE3> camera_from_board;  // of each view
};

struct Problem {
  std::string model;
  Fitted truth;
  std::vector<calvin::View> views;
};

// Board tilted 0 to 45 degrees, 0.25 to 0.8 of the image wide, in all of the image. For a fisheye
// all corners within 72 degrees of the axis: OpenCV's knows the tangent only.
inline Problem make_problem(const std::string& model, int views) {
  calvin::scenes::Random random(7);
  const calvin::Camera camera = calvin::scenes::random_camera(model, random, kSize);
  const auto points = kBoard.points();
  const auto ahead = [&points](const SE3& pose) {
    return std::all_of(points.begin(), points.end(), [&pose](const Eigen::Vector3d& p) {
      const Eigen::Vector3d at = pose * p;
      return at.z() > 0.3 * at.norm();
    });
  };
  Problem problem;
  problem.model = model;
  problem.truth.intrinsics = camera.parameters();
  while (static_cast<int>(problem.truth.camera_from_board.size()) < views) {
    const double tilt = calvin::scenes::uniform(random, 0, std::numbers::pi / 4);
    const SE3 pose = calvin::scenes::random_pose(camera, kBoard, random, tilt);
    if (!ahead(pose)) continue;
    problem.truth.camera_from_board.push_back(pose);
    problem.views.push_back(calvin::scenes::observe(camera, kBoard, pose, kSigma, random));
    for (calvin::Pixel& p : problem.views.back().observation.uv) {
      p = {static_cast<float>(p.u), static_cast<float>(p.v)};
    }
  }
  return problem;
}

// The start that those get who have none of their own: near the truth, free of charge.
inline Fitted near_truth(const Problem& problem) {
  Fitted start = problem.truth;
  start.intrinsics[0] *= 1.05;
  start.intrinsics[1] *= 1.05;
  start.intrinsics[2] = (kSize.width - 1) / 2.0;
  start.intrinsics[3] = (kSize.height - 1) / 2.0;
  std::fill(start.intrinsics.begin() + 4, start.intrinsics.end(), 0.0);
  for (SE3& pose : start.camera_from_board) {
    pose.rotation = calvin::exp_so3({0.02, -0.02, 0.02}) * pose.rotation;
    pose.translation *= 1.04;
  }
  return start;
}

// Sum of the squared distances, px^2. Absent where a corner has no projection.
inline std::optional<double> cost_of(const Problem& problem, const Fitted& fitted) {
  const auto camera = calvin::Camera::make(problem.model, kSize, fitted.intrinsics);
  if (!camera || fitted.camera_from_board.size() != problem.views.size()) return std::nullopt;
  const auto points = kBoard.points();
  double cost = 0;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto at = camera->project(fitted.camera_from_board[v] * points[i]);
      if (!at) return std::nullopt;
      const calvin::Pixel seen = problem.views[v].observation.uv[i];
      cost += std::pow(at->u - seen.u, 2) + std::pow(at->v - seen.v, 2);
    }
  }
  return cost;
}

}  // namespace bench
