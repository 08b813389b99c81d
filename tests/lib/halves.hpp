// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibrations of two halves of some views, and how far they are apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/solve/difference.hpp"
#include "calvin/solve/judge/projection_error.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin::scenes {

inline Eigen::MatrixXd covariance_of(const Calibration& calibration) {
  const auto n = static_cast<Eigen::Index>(calibration.parameters.size());
  return Eigen::Map<const Eigen::MatrixXd>(calibration.covariance.data(), n, n);
}

// What halves of a set are apart by: the largest difference of a projection where both covered the
// picture, in px and over what both covariances predict of the worst place there, and the squares
// of the parameters' differences over their predictions.
struct Apart {
  std::vector<double> pixels;
  std::vector<double> projections;
  std::vector<double> parameters;
};

inline void compare(const Calibration& a, const Calibration& b, Apart& apart) {
  const Camera first = Camera::make(a).value();
  const Eigen::MatrixXd predicted = covariance_of(a) + covariance_of(b);
  DifferenceOptions where;
  where.columns = 33;
  where.rows = 25;
  where.focus = {a.covered, b.covered};
  const auto found = difference(first, Camera::make(b).value(), where);
  ASSERT_TRUE(found) << found.error().message;
  std::vector<Pixel> covered;  // by both, as far as they were compared
  for (const Difference::Cell& cell : found->cells) {
    if (cell.in_focus) covered.push_back(cell.at);
  }
  const auto grids =
      projection_grids(first, estimated_columns(a).value(), convex_hull(std::move(covered)));
  const auto promise = promise_of(grids, predicted);
  ASSERT_TRUE(promise);
  apart.pixels.push_back(found->focus.max);
  apart.projections.push_back(found->focus.max / promise->covered);
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double off = a.parameters[i].value - b.parameters[i].value;
    apart.parameters.push_back(off * off / predicted(k, k));
  }
}

// Solves so many random halves of the views, the same ones for each call. Halves that do not both
// determine the model are not compared.
inline Apart halves(const std::vector<View>& views, ImageSize size, const SolveOptions& options,
                    int count) {
  std::mt19937 random(7);
  Apart apart;
  std::vector<View> shuffled = views;
  for (int i = 0; i < count; ++i) {
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    const auto half = shuffled.begin() + static_cast<std::ptrdiff_t>(shuffled.size() / 2);
    const std::vector<View> first(shuffled.begin(), half);
    const std::vector<View> second(half, shuffled.end());
    const auto a = solve(first, size, options);
    const auto b = solve(second, size, options);
    if (!a || !b || a->calibration.model != b->calibration.model) continue;
    compare(a->calibration, b->calibration, apart);
  }
  return apart;
}

}  // namespace calvin::scenes
