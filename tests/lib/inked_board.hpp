// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards whose corners are not where they were meant to be, and views of them.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "scenes.hpp"

namespace calvin::scenes {

inline constexpr double kNoise = 0.05;  // px

// Views of a board whose points are elsewhere, turned any way about its normal.
inline std::vector<View> views_of(const Camera& camera, const std::vector<Eigen::Vector3d>& points,
                                  int count, Random& random) {
  std::normal_distribution<double> noise(0, kNoise);
  std::vector<View> views;
  while (static_cast<int>(views.size()) < count) {
    SE3 pose = random_pose(camera, kBoard, random, uniform(random, 0, 0.7));
    const double turn = uniform(random, -std::numbers::pi, std::numbers::pi);
    const Eigen::Vector3d middle = (kBoard.points().front() + kBoard.points().back()) / 2;
    const Eigen::Matrix3d rotation = pose.rotation * exp_so3({0, 0, turn});
    pose = {rotation, pose * middle - rotation * middle};
    View view;
    view.board = kBoard;
    view.observation.image_size = kSize;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto at = camera.project(pose * points[i]);
      if (!at || at->u < 0 || at->v < 0 || at->u > kSize.width - 1 || at->v > kSize.height - 1) {
        break;
      }
      view.observation.ids.push_back(static_cast<int>(i));
      view.observation.uv.push_back({at->u + noise(random), at->v + noise(random)});
      view.observation.sigma.push_back(kNoise);
    }
    if (view.observation.ids.size() == points.size()) views.push_back(std::move(view));
  }
  return views;
}

// What ink may do: displacements of `sigma` m without what is a shift, turn, scale, shear, tilt or
// curvature of the board.
[[nodiscard]] Eigen::MatrixX3d random_offsets(double sigma, Random& random);

}  // namespace calvin::scenes
