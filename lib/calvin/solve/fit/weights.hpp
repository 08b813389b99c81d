// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The weights of corners, from their sigmas and from the residuals of a fit. Internal.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// The weights of views are multiplied by `sigma` (their median sigma, px) so that distances times
// weights stay near px. `known` says whether the detector gave all of them.
struct WeightScale {
  double sigma = 1;
  bool known = false;
};

// Makes the median weight 1.
WeightScale normalise_weights(std::span<PointSet> views);

// The weights per view before a fit, which sets those of outliers to 0.
using Weights = std::vector<std::vector<double>>;
[[nodiscard]] Weights weights_of(std::span<const PointSet> views);

// How many of the directions the priors determine and not the corners, no whole number: the trace
// of the priors' information times the covariance of all.
[[nodiscard]] double determined_by_priors(const Fit& fit, const Parameterization& parameterization);

// The number of the corners' residuals less the number of unknowns that were fitted to them.
[[nodiscard]] double degrees_of_freedom(const Fit& fit, const Parameterization& parameterization);

// The degrees of freedom of Fit::cost, which has the priors' residuals as well.
[[nodiscard]] double degrees_of_cost(const Fit& fit, const Parameterization& parameterization);

// sigma^2 = sigma_i^2 + sigma_0^2: where corners are worse than their sigmas say, sigma_0 (px) is
// what all of them have in common. It is estimated by a median, so that outliers have no say.
// `original` are the weights before any were changed. 0 where a common sigma would change nothing:
// all sigmas nearly equal, or large enough. Means nothing where `stop` was requested.
[[nodiscard]] double common_sigma(const Fit& fit, const Weights& original, const WeightScale& scale,
                                  const std::stop_token& stop);
[[nodiscard]] std::vector<PointSet> with_common_sigma(std::vector<PointSet> views,
                                                      const Weights& original,
                                                      const WeightScale& scale, double common);

// The weights where each view has its own factor of the sigmas: the root mean square of its corners
// in use over their sigmas, the geometric mean of all views being 1.
[[nodiscard]] Weights with_view_factors(const Fit& fit, const Weights& original,
                                        const WeightScale& scale);

// The square root of chi^2 per degree of freedom over the corners in use, by the detector's sigmas.
[[nodiscard]] double chi_of(const Fit& fit, const Parameterization& parameterization,
                            const Weights& original, const WeightScale& scale);

}  // namespace calvin
