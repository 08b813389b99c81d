// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/solve_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/conclude.hpp"
#include "calvin/solve/fit.hpp"
#include "calvin/solve/weights.hpp"

namespace calvin {

namespace {

// A board bends by less than this of its size, 1 sigma: what keeps its curvature from running away
// where the views tell nothing of it.
constexpr double kBendPrior = 0.01;

// The common sigma is found when it changes by less than this part.
constexpr double kSettled = 0.02;

double extent_of(const std::vector<PointSet>& views) {
  double extent = 0;
  for (const PointSet& view : views) {
    for (const Eigen::Vector3d& p : view.points) {
      extent = std::max(extent, (p - view.points.front()).norm());
    }
  }
  return extent;
}

}  // namespace

Result<Solution> solve_points(std::vector<PointSet> views, const BoardShape& shape,
                              ImageSize image_size, const SolveOptions& options,
                              const std::stop_token& stop) {
  auto freedom = make_freedom(options, image_size, static_cast<int>(shape.modes));
  if (!freedom) return tl::unexpected<Error>(freedom.error());
  const std::vector<bool> all(views.size(), true);
  if (const Status status = enough(views, all, *freedom, options.model); !status) {
    return tl::unexpected<Error>(status.error());
  }
  const WeightScale scale = normalise_weights(views);
  const double bend = kBendPrior * extent_of(views) / scale.sigma;
  for (int m = freedom->layout.shared() - freedom->layout.modes; m < freedom->layout.shared();
       ++m) {
    freedom->priors.push_back({m, 0, bend});
  }
  const Weights told = weights_of(views);
  Fit fit = fit_camera(std::move(views), shape, image_size, *freedom, options, stop);
  constexpr int kRounds = 3;
  double before = 0;
  for (int i = 0; i < kRounds && fit.converged && scale.known; ++i) {
    const double common = common_sigma(fit, told, scale, stop);
    if (std::abs(common - before) <= kSettled * common) break;
    fit = fit_camera(with_common_sigma(std::move(fit.views), told, scale, common), shape,
                     image_size, *freedom, options, stop);
    before = common;
  }
  const double chi = fit.converged ? chi_of(fit, told, scale) : 1;
  return conclude({fit, *freedom, shape, scale, chi}, image_size, options, stop);
}

}  // namespace calvin
