// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Means and spreads of the parameters over the sets of table2, and whether other spreads fit them.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "calvin/core/calibration.hpp"

namespace table2 {

// A row for each set, a column for each parameter.
using Table = Eigen::MatrixXd;

inline Eigen::VectorXd means(const Table& values) { return values.colwise().mean(); }

// Standard deviations about the mean.
inline Eigen::VectorXd spreads(const Table& values) {
  const Table centred = values.rowwise() - values.colwise().mean();
  return (centred.colwise().squaredNorm() / static_cast<double>(values.rows() - 1)).cwiseSqrt();
}

// e^T C^-1 e / n for the estimated parameters, e from `centre`: 1 on average where the covariance
// is right.
inline double normalised_square(const calvin::Calibration& c, const Eigen::VectorXd& centre) {
  const Eigen::Index n = centre.size();
  const Eigen::Map<const Eigen::MatrixXd> covariance(c.covariance.data(), n, n);
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::VectorXd e(n);
  for (Eigen::Index i = 0, k = 0; i < n; ++k) {
    const calvin::Parameter& p = c.parameters[static_cast<std::size_t>(k)];
    if (!p.sigma) continue;
    e[i] = (p.value - centre[i]) * scale[i];
    ++i;
  }
  const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  return e.dot(correlation.ldlt().solve(e)) / static_cast<double>(n);
}

struct Region {
  double distance = 0;  // squared Mahalanobis distance of the other's spreads
  double limit = 0;     // that 95 % of our own groups stay below
  [[nodiscard]] bool inside() const { return distance <= limit; }
};

// Whether the standard deviations that somebody found over `group` sets could be ours: groups of as
// many of our sets are drawn again and again, and the logarithms of their standard deviations are
// compared jointly, correlations included.
inline Region joint_region(const Table& values, const Eigen::VectorXd& others, int group,
                           std::mt19937_64& random) {
  constexpr int kDraws = 4000;
  Table logs(kDraws, values.cols());
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.rows()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  Table drawn(group, values.cols());
  for (int draw = 0; draw < kDraws; ++draw) {
    for (int i = 0; i < group; ++i) {
      const auto at = static_cast<std::size_t>(i);
      std::uniform_int_distribution<std::size_t> pick(at, order.size() - 1);
      std::swap(order[at], order[pick(random)]);
      drawn.row(i) = values.row(order[at]);
    }
    logs.row(draw) = spreads(drawn).array().log();
  }
  const Eigen::VectorXd centre = means(logs);
  const Table centred = logs.rowwise() - centre.transpose();
  const Eigen::MatrixXd covariance = centred.transpose() * centred / (kDraws - 1);
  const Eigen::LDLT<Eigen::MatrixXd> factors(covariance);
  std::vector<double> distances;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::VectorXd e = centred.row(draw);
    distances.push_back(e.dot(factors.solve(e)));
  }
  const auto nth = distances.begin() + kDraws * 95 / 100;
  std::nth_element(distances.begin(), nth, distances.end());
  const Eigen::VectorXd e = others.array().log().matrix() - centre;
  return {e.dot(factors.solve(e)), *nth};
}

}  // namespace table2
