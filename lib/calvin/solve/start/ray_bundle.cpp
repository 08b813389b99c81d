// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Widens bundles of rays, and weighs rays by how far off they are.

#include "calvin/solve/start/ray_bundle.hpp"

#include <algorithm>
#include <cstddef>

#include "calvin/geometry/se3.hpp"

namespace calvin {

Eigen::Matrix3d widening(const std::vector<Eigen::Vector3d>& rays) {
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

bool reweight_far_off(const std::vector<Eigen::Vector3d>& rays, const std::vector<double>& angles,
                      std::vector<double>& weights) {
  constexpr double kFarOff = 4;  // medians; the largest of 1000 Gaussian distances is at 3.2
  constexpr double kLeast = 1e-9;
  std::vector<double> sorted;
  sorted.reserve(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!rays[i].isZero()) sorted.push_back(angles[i]);
  }
  if (sorted.empty()) return false;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = std::max(*middle, kLeast);
  // What is at the middle divides the smaller angles from the larger.
  if (*std::max_element(middle, sorted.end()) <= kFarOff * median) return false;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    weights[i] = 1 / (1 + angles[i] * angles[i] / (median * median));
  }
  return true;
}

}  // namespace calvin
