// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far a calibration is from the true camera.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/se3.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

// The largest distance of a projection from the true one, px, the best common rotation taken out,
// over a grid of the places that the polygon contains, or of all.
inline double worst_error(const Calibration& calibration, const Camera& truth,
                          const std::vector<Pixel>& within) {
  const Camera camera = Camera::make(calibration).value();
  std::vector<Pixel> seen;
  std::vector<Eigen::Vector3d> rays;
  for (int i = 0; i < 17 * 13; ++i) {
    const Pixel at = {(truth.image_size().width - 1) * (i % 17) / 16.0,
                      (truth.image_size().height - 1) * (i / 17) / 12.0};
    const auto ray = truth.unproject(at);
    if (!ray || (!within.empty() && !contains(within, at))) continue;
    seen.push_back(at);
    rays.push_back(*ray);
  }
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  double worst = 0;
  for (int iteration = 0; iteration < 5; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    worst = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto at = camera.project(exp_so3(turn) * rays[i]);
      if (!at) return HUGE_VAL;
      const Eigen::Vector2d error(at->u - seen[i].u, at->v - seen[i].v);
      worst = std::max(worst, error.norm());
      Eigen::Matrix<double, 2, 3> j;
      for (int k = 0; k < 3; ++k) {
        const auto moved =
            camera.project(exp_so3(turn + 1e-6 * Eigen::Vector3d::Unit(k)) * rays[i]);
        if (!moved) return HUGE_VAL;
        j.col(k) = Eigen::Vector2d(moved->u - at->u, moved->v - at->v) / 1e-6;
      }
      normal += j.transpose() * j;
      gradient += j.transpose() * error;
    }
    turn -= normal.ldlt().solve(gradient);
  }
  return worst;
}

}  // namespace calvin::scenes
