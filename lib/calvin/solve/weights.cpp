// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/weights.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace calvin {

namespace {

// Sigmas further apart than this are taken as this far: one absurd value must not decide alone.
constexpr double kWidestRatio = 1e3;

struct Corner {
  double square = 0;    // of its distance, px^2
  double variance = 0;  // px^2
};

std::vector<Corner> corners_of(const Fit& fit, double sigma) {
  std::vector<Corner> corners;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    const PointSet& view = fit.views[v];
    std::size_t at = 0;
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (!(view.weight[i] > 0)) continue;
      const double own = sigma / view.weight[i];
      corners.push_back({fit.squares[v][at++], own * own});
    }
  }
  return corners;
}

// sum(square / (variance + common)) = degrees, by bisection: the sum falls as `common` grows.
double common_variance(const std::vector<Corner>& corners, double degrees) {
  const auto sum = [&corners](double common) {
    double total = 0;
    for (const Corner& c : corners) total += c.square / (c.variance + common);
    return total;
  };
  double low = 0;
  double high = 0;
  for (const Corner& c : corners) high += c.square / degrees;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (sum(middle) > degrees ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

WeightScale normalise_weights(std::span<PointSet> views) {
  std::vector<double> all;
  WeightScale scale = {1, true};
  for (const PointSet& view : views) {
    all.insert(all.end(), view.weight.begin(), view.weight.end());
    scale.known = scale.known && view.sigma_known;
  }
  if (all.empty()) return {};
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  scale.sigma = 1 / *middle;
  for (PointSet& view : views) {
    for (double& w : view.weight) w = std::clamp(w * scale.sigma, 1 / kWidestRatio, kWidestRatio);
  }
  return scale;
}

double degrees_of_freedom(const Fit& fit) {
  double degrees = -static_cast<double>(fit.information.rows());
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (fit.used[v]) degrees += 2 * static_cast<double>(fit.views[v].used()) - 6;
  }
  return degrees;
}

bool add_common_sigma(Fit& fit, const WeightScale& scale) {
  constexpr double kNearlyOne = 1.02;
  constexpr double kNearlyEqual = 1.05;
  const double degrees = degrees_of_freedom(fit);
  if (!(degrees > 0) || fit.cost < kNearlyOne * degrees * scale.sigma * scale.sigma) return false;
  const std::vector<Corner> corners = corners_of(fit, scale.sigma);
  const auto [least, most] = std::minmax_element(
      corners.begin(), corners.end(),
      [](const Corner& a, const Corner& b) { return a.variance < b.variance; });
  if (most->variance < kNearlyEqual * least->variance) return false;
  const double common = common_variance(corners, degrees);
  for (PointSet& view : fit.views) {
    for (double& w : view.weight) {
      if (w > 0) w = scale.sigma / std::sqrt(scale.sigma * scale.sigma / (w * w) + common);
    }
  }
  return true;
}

}  // namespace calvin
