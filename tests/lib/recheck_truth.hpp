// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a recheck should find: how far two cameras are apart where boards were seen.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

// The largest distance between what two cameras see along the same rays, one of them turned as
// well as it goes, on a grid over the part of the image where the views have corners: by numeric
// least squares over the three angles.
inline double true_change(const Camera& from, const Camera& to, const std::vector<View>& views) {
  std::vector<Pixel> corners;
  for (const View& view : views) {
    corners.insert(corners.end(), view.observation.uv.begin(), view.observation.uv.end());
  }
  const auto seen = convex_hull(std::move(corners));
  std::vector<Eigen::Vector3d> rays;
  std::vector<Pixel> at;
  for (int y = 0; y <= 48; ++y) {
    for (int x = 0; x <= 64; ++x) {
      const Pixel p = {x * (kSize.width - 1) / 64.0, y * (kSize.height - 1) / 48.0};
      const auto ray = from.unproject(p);
      if (!ray || !contains(seen, p)) continue;
      rays.push_back(*ray);
      at.push_back(p);
    }
  }
  const auto errors = [&](const Eigen::Vector3d& w) {
    const Eigen::Matrix3d r = exp_so3(w);
    Eigen::VectorXd e = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(rays.size()));
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto q = to.project(r * rays[i]);
      if (!q) continue;
      e[2 * static_cast<Eigen::Index>(i)] = q->u - at[i].u;
      e[2 * static_cast<Eigen::Index>(i) + 1] = q->v - at[i].v;
    }
    return e;
  };
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  for (int round = 0; round < 10; ++round) {
    Eigen::MatrixXd j(2 * static_cast<Eigen::Index>(rays.size()), 3);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(k);
      j.col(k) = (errors(w + h) - errors(w - h)) / 2e-6;
    }
    const Eigen::Matrix3d normal = transposed_product(j, j);
    w -= normal.inverse() * (j.transpose() * errors(w));
  }
  const Eigen::VectorXd e = errors(w);
  double farthest = 0;
  for (Eigen::Index i = 0; i < e.size(); i += 2)
    farthest = std::max(farthest, e.segment<2>(i).norm());
  return farthest;
}

inline std::vector<View> views_of(const Camera& camera, Random& random, int count, double sigma) {
  return scenes::observe_all(camera, kBoard, scenes::random_poses(camera, kBoard, random, count),
                             sigma, random);
}

}  // namespace calvin::scenes
