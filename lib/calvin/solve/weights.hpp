// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How much each corner counts. Internal.
#pragma once

#include <span>

#include "calvin/solve/fit.hpp"
#include "calvin/solve/points.hpp"

namespace calvin {

// The weights of views are multiplied by `sigma` (their median sigma, px) so that distances times
// weights stay near px. `known` says whether the detector gave all of them.
struct WeightScale {
  double sigma = 1;
  bool known = false;
};

// Makes the median weight 1.
WeightScale normalise_weights(std::span<PointSet> views);

// Residuals less what was fitted to them.
[[nodiscard]] double degrees_of_freedom(const Fit& fit);

// sigma^2 = sigma_i^2 + sigma_0^2: where corners are worse than their sigmas say, sigma_0 is what
// all of them have in common, found so that chi is 1. Puts the new weights into fit.views. False
// where that changes nothing, because chi is 1 already or all sigmas are nearly equal.
[[nodiscard]] bool add_common_sigma(Fit& fit, const WeightScale& scale);

}  // namespace calvin
