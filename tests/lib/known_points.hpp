// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Objects whose points are known, and where a camera sees them from.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/kinds.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

// What is in view: an object in space, or a plane.
enum class Object { kSpace, kPlane };

// Points in a box of 200 x 150 x 100 mm; in a plane, those of a grid.
inline Board object(Object kind, Random& random) {
  if (kind == Object::kPlane) return kBoard;
  std::vector<PointBoard::Dot> dots;
  for (int i = 0; i < 40; ++i) {
    dots.push_back({i, uniform(random, -0.1, 0.1), uniform(random, -0.075, 0.075), 0,
                    uniform(random, -0.05, 0.05)});
  }
  return PointBoard::make("box", dots).value();
}

// The object before the camera, filling a third of the picture and more, a plane tilted by 20 to 50
// degrees.
inline SE3 pose_for(const Camera& camera, const Board& board, Object kind, Random& random) {
  for (;;) {
    const double side = uniform(random, 0, 2 * std::numbers::pi);
    const double tilt = kind == Object::kPlane ? uniform(random, 20, 50) : uniform(random, 0, 180);
    const Eigen::Vector3d axis(std::cos(side), std::sin(side),
                               kind == Object::kPlane ? 0 : uniform(random, -1, 1));
    SE3 pose;
    pose.rotation = exp_so3(axis.normalized() * tilt * std::numbers::pi / 180) *
                    exp_so3({0, 0, uniform(random, -0.5, 0.5)});
    const double distance = camera.fx() * 0.2 / (kSize.width * uniform(random, 0.35, 0.7));
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : board.points()) middle += p / board.point_count();
    pose.translation = Eigen::Vector3d(distance * uniform(random, -0.1, 0.1),
                                       distance * uniform(random, -0.1, 0.1), distance) -
                       pose.rotation * middle;
    if (sees_all(camera, board, pose)) return pose;
  }
}

inline PointSet points_of(const View& view) {
  return to_points(view.board, view.board.points(), view.observation);
}

}  // namespace calvin::scenes
