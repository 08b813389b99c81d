// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which corners and views are clearly wrong, from how far they are from the fit. Internal.
#pragma once

#include <span>
#include <vector>

namespace calvin {

// Which corners of one view take part in the solve.
struct ViewMask {
  bool view = true;           // false: the whole view is an outlier
  std::vector<bool> corners;  // per corner; all false where the view is an outlier

  friend bool operator==(const ViewMask&, const ViewMask&) = default;
};

// The standard deviation per coordinate of distances of Gaussian points from their mean, by the
// median, so that up to half of them may be gross; never below kLeastScale, which it is for no
// corners.
[[nodiscard]] double robust_scale(std::vector<double> distances);
inline constexpr double kLeastScale = 0.01;  // px, below what any detector reaches

// The root mean square of the nearest three quarters of the distances, to compare two fits to the
// same corners: it tells much smaller differences than a median does.
[[nodiscard]] double trimmed_rms(std::vector<double> distances);

// `distances[view][corner]`: weighted distance from the fit, px, finite.
//
// A corner is wrong beyond 6 times the larger of the scale of all corners and of its own view's:
// of Gaussian ones less than one in 10^6 goes, so neither result nor covariance is biased, and the
// corners of a blurred view are judged among themselves. A view is wrong where its scale is 4
// times the median over all views, and beyond 6 deviations (by the median) of the views' scales:
// such a view is another board, another labelling or a smear. Two views cannot outvote each other:
// with fewer than four, no view is judged.
[[nodiscard]] std::vector<ViewMask> find_outliers(std::span<const std::vector<double>> distances);

[[nodiscard]] bool any_outlier(std::span<const ViewMask> masks);

}  // namespace calvin
