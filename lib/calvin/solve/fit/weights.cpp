// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Weights from sigmas, the sigma that all corners share, and chi.

#include "calvin/solve/fit/weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

// Ratio to the median sigma: sigmas are clamped to this range, for one absurd value must not decide
// alone.
constexpr double kWidestRatio = 1e3;

struct Corner {
  double square = 0;    // of the distance from its projection, px^2
  double variance = 0;  // by the detector, px^2
};

// All corners of the views used, those left out too.
std::vector<Corner> corners_of(const Fit& fit, const Weights& original, double sigma) {
  std::size_t count = 0;
  for (const auto& view : original) count += view.size();
  std::vector<Corner> corners;
  corners.reserve(count);
  for (std::size_t v = 0; v < original.size(); ++v) {
    for (std::size_t i = 0; fit.used[v] && i < original[v].size(); ++i) {
      const double own = sigma / original[v][i];
      if (std::isfinite(fit.squares[v][i])) corners.push_back({fit.squares[v][i], own * own});
    }
  }
  return corners;
}

// Whether all corners of the views used have about the same sigma.
bool nearly_equal(const Fit& fit, const Weights& original) {
  constexpr double kNearlyEqual = 1.05;  // of the variances
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (std::size_t v = 0; v < original.size(); ++v) {
    if (!fit.used[v]) continue;
    for (const double w : original[v]) {
      least = std::min(least, w);
      most = std::max(most, w);
    }
  }
  return most * most < kNearlyEqual * least * least;
}

// The common variance for which the median of square / (variance + common) is that of the sum of
// two squared standard normals, 2 ln 2; by bisection, as the median falls with `common`. 0 where
// the median is smaller without it.
double common_variance(const std::vector<Corner>& corners, const std::stop_token& stop) {
  const double wanted = 2 * std::numbers::ln2;
  std::vector<double> ratios(corners.size());
  const auto median = [&](double common) {
    std::transform(corners.begin(), corners.end(), ratios.begin(),
                   [common](const Corner& c) { return c.square / (c.variance + common); });
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
  };
  if (corners.empty() || !(median(0) > wanted)) return 0;
  double low = 0;
  double high = 1;
  while (!stop.stop_requested() && median(high) > wanted && high < 1e12) high *= 4;
  for (int i = 0; i < 40 && !stop.stop_requested(); ++i) {
    const double middle = (low + high) / 2;
    (median(middle) > wanted ? low : high) = middle;
  }
  return high;
}

}  // namespace

WeightScale normalise_weights(std::span<PointSet> views) {
  std::vector<double> all;
  WeightScale scale = {1, true};
  all.reserve(views.empty() ? 0 : views.size() * views.front().size());
  for (const PointSet& view : views) {
    all.insert(all.end(), view.weight.begin(), view.weight.end());
    scale.known = scale.known && view.sigma_known;
  }
  if (all.empty()) return {};
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  if (*least < *most) std::nth_element(all.begin(), middle, all.end());
  scale.sigma = 1 / *middle;
  for (PointSet& view : views) {
    for (double& w : view.weight) w = std::clamp(w * scale.sigma, 1 / kWidestRatio, kWidestRatio);
  }
  return scale;
}

double determined_by_priors(const Fit& fit, const Parameterization& parameterization) {
  if (parameterization.table.priors().empty()) return 0;
  const Eigen::Index n = fit.information.rows();
  const auto covariance =
      scaled_solve(fit.information, Eigen::MatrixXd::Identity(n, n), kLeastPivot);
  if (!covariance) return 0;
  double determined = 0;
  for (const auto& prior : parameterization.table.priors()) {
    const Eigen::RowVectorXd along = parameterization.basis.row(prior.unknown);
    determined += (along * *covariance).dot(along) / (prior.sigma * prior.sigma);
  }
  return determined;
}

double degrees_of_freedom(const Fit& fit, const Parameterization& parameterization) {
  double degrees =
      determined_by_priors(fit, parameterization) - static_cast<double>(fit.information.rows());
  if (fit.board) degrees -= fit.board->determined;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (fit.used[v]) degrees += 2 * static_cast<double>(fit.views[v].used()) - 6;
  }
  return degrees;
}

double degrees_of_cost(const Fit& fit, const Parameterization& parameterization) {
  // The prior of a held parameter has no residual.
  const auto counts = [&parameterization](const auto& prior) {
    return parameterization.basis.row(prior.unknown).any();
  };
  const auto& all = parameterization.table.priors();
  const auto priors = std::count_if(all.begin(), all.end(), counts);
  return degrees_of_freedom(fit, parameterization) + static_cast<double>(priors) -
         determined_by_priors(fit, parameterization);
}

Weights weights_of(std::span<const PointSet> views) {
  Weights weights;
  weights.reserve(views.size());
  for (const PointSet& view : views) weights.push_back(view.weight);
  return weights;
}

double common_sigma(const Fit& fit, const Weights& original, const WeightScale& scale,
                    const std::stop_token& stop) {
  if (nearly_equal(fit, original)) return 0;
  return std::sqrt(common_variance(corners_of(fit, original, scale.sigma), stop));
}

std::vector<PointSet> with_common_sigma(std::vector<PointSet> views, const Weights& original,
                                        const WeightScale& scale, double common) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    std::transform(original[v].begin(), original[v].end(), views[v].weight.begin(),
                   [&](double w) { return scale.sigma / std::hypot(scale.sigma / w, common); });
  }
  return views;
}

Weights with_view_factors(const Fit& fit, const Weights& original, const WeightScale& scale) {
  constexpr double kMost = 4;  // times the sigmas of other views, or a part of them
  std::vector<double> logs(original.size(), 0);
  double sum = 0;
  double views = 0;
  for (std::size_t v = 0; v < original.size(); ++v) {
    double squares = 0;
    double corners = 0;
    for (std::size_t i = 0; fit.used[v] && i < original[v].size(); ++i) {
      if (!(fit.views[v].weight[i] > 0)) continue;
      const double w = original[v][i] / scale.sigma;
      squares += fit.squares[v][i] * w * w;
      corners += 1;
    }
    // A pose takes 6 of the residuals.
    if (!(corners > 3) || !(squares > 0)) continue;
    logs[v] = std::log(squares / (2 * corners - 6)) / 2;
    sum += logs[v];
    views += 1;
  }
  Weights weights = original;
  for (std::size_t v = 0; v < original.size(); ++v) {
    if (logs[v] == 0) continue;
    const double factor = std::clamp(std::exp(logs[v] - sum / views), 1 / kMost, kMost);
    for (double& w : weights[v]) w /= factor;
  }
  return weights;
}

double chi_of(const Fit& fit, const Parameterization& parameterization, const Weights& original,
              const WeightScale& scale) {
  double sum = 0;
  for (std::size_t v = 0; v < original.size(); ++v) {
    for (std::size_t i = 0; fit.used[v] && i < original[v].size(); ++i) {
      const double w = original[v][i] / scale.sigma;
      if (fit.views[v].weight[i] > 0) sum += fit.squares[v][i] * w * w;
    }
  }
  return std::sqrt(sum / degrees_of_freedom(fit, parameterization));
}

}  // namespace calvin
