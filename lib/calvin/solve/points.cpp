// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace calvin {

namespace {

// Absent where the detector says nothing of the corner.
std::optional<double> weight_of(const Observation& observation, std::size_t i) {
  if (i >= observation.sigma.size()) return std::nullopt;
  const double sigma = observation.sigma[i];
  if (!std::isfinite(sigma) || !(sigma > 0)) return std::nullopt;
  return 1 / sigma;
}

}  // namespace

std::size_t PointSet::used() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0; }));
}

void PointSet::clear() {
  ids.clear();
  points.clear();
  uv.clear();
  weight.clear();
}

void PointSet::append(const PointSet& from, std::size_t i) {
  ids.push_back(from.ids[i]);
  points.push_back(from.points[i]);
  uv.push_back(from.uv[i]);
  weight.push_back(from.weight[i]);
}

PointSet to_points(const Board& board, const Observation& observation) {
  const std::vector<Eigen::Vector3d> all = board.points();
  PointSet view;
  view.timestamp = observation.timestamp;
  view.ids = observation.ids;
  view.uv = observation.uv;
  for (std::size_t i = 0; i < observation.ids.size(); ++i) {
    view.points.push_back(all[static_cast<std::size_t>(observation.ids[i])]);
    const auto weight = weight_of(observation, i);
    view.weight.push_back(weight.value_or(1));
    view.sigma_known = view.sigma_known && weight;
  }
  return view;
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
