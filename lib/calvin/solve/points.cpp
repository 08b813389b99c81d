// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/points.hpp"

#include <algorithm>
#include <cmath>

namespace calvin {

namespace {

// Sigmas further apart than this are taken as this far: one absurd value must not decide alone.
constexpr double kWidestRatio = 1e3;

double weight_of(const Observation& observation, std::size_t i) {
  if (i >= observation.sigma.size()) return 1;
  const double sigma = observation.sigma[i];
  return std::isfinite(sigma) && sigma > 0 ? 1 / sigma : 1;
}

}  // namespace

std::size_t PointSet::used() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0; }));
}

PointSet to_points(const Board& board, const Observation& observation) {
  const std::vector<Eigen::Vector3d> all = board.points();
  PointSet view;
  view.timestamp = observation.timestamp;
  view.ids = observation.ids;
  view.uv = observation.uv;
  for (std::size_t i = 0; i < observation.ids.size(); ++i) {
    view.points.push_back(all[static_cast<std::size_t>(observation.ids[i])]);
    view.weight.push_back(weight_of(observation, i));
  }
  return view;
}

void normalise_weights(std::span<PointSet> views) {
  std::vector<double> all;
  for (const PointSet& view : views) {
    all.insert(all.end(), view.weight.begin(), view.weight.end());
  }
  if (all.empty()) return;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  const double median = *middle;
  for (PointSet& view : views) {
    for (double& w : view.weight) w = std::clamp(w / median, 1 / kWidestRatio, kWidestRatio);
  }
}

bool spans_plane(const PointSet& view) {
  if (view.used() < 4) return false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double n = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    mean += view.points[i];
    n += 1;
  }
  mean /= n;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    const Eigen::Vector3d d = view.points[i] - mean;
    scatter += d * d.transpose();
  }
  // The sum of products of two eigenvalues: on one line it is zero.
  const auto minor = [&scatter](int i, int j) {
    return scatter(i, i) * scatter(j, j) - scatter(i, j) * scatter(i, j);
  };
  const double trace = scatter.trace();
  return minor(0, 1) + minor(1, 2) + minor(0, 2) > 1e-8 * trace * trace;
}

}  // namespace calvin
