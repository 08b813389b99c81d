// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What linear solutions for points and their rays do to the rays first. Internal.
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"

namespace calvin {

// The linear map that takes a narrow bundle of rays to a wide one about z. It conditions the linear
// solution: in a narrow bundle, the same ray for all points fits nearly as well as the truth.
[[nodiscard]] inline Eigen::Matrix3d widening(const std::vector<Eigen::Vector3d>& rays) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& ray : rays) mean += ray;
  const Eigen::Matrix3d turn = rotation_between(mean, Eigen::Vector3d::UnitZ());
  double sine = 0;
  double count = 0;
  for (const Eigen::Vector3d& ray : rays) {
    sine += (turn * ray).head<2>().norm();
    count += ray.norm();
  }
  const double scale = std::clamp(count / sine, 1.0, 1e6);
  return Eigen::Vector3d(scale, scale, 1).asDiagonal() * turn;
}

}  // namespace calvin
