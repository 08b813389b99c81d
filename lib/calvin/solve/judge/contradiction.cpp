// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Gradients of single views, each whitened by what all views say.

#include "calvin/solve/judge/contradiction.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin {

namespace {

// The W with W W^T = m, for a symmetric m whose diagonal is positive.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& m) {
  const Eigen::VectorXd scale = m.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const auto eigen = symmetric_eigen(inverse.asDiagonal() * m * inverse.asDiagonal());
  if (!eigen) return Eigen::MatrixXd::Zero(m.rows(), m.cols());
  return scale.asDiagonal() * eigen->vectors * eigen->values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

double ChiSquare::deviations() const {
  if (!(degrees > 0)) return 0;
  const double width = 2 / (9 * degrees);
  return (std::cbrt(ratio()) - (1 - width)) / std::sqrt(width);
}

Contradiction::Contradiction(const Eigen::MatrixXd& covariance)
    : root_(root_of(covariance)),
      scatter_(Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols())) {}

// The fit to all views has absorbed a part of each: what is left of a gradient has the variance
// k - k^2 along an eigenvector of the view's share of the information, k in 0..1. Divided by the
// root of 1 - k it spreads as if nothing were absorbed (R. Bell, D. McCaffrey, Survey Methodology
// 28(2), 2002).
void Contradiction::add(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient) {
  constexpr double kNothing = 1e-10;
  constexpr double kLeastLeft = 0.02;  // a view that decides alone tells nothing of its error
  const auto eigen = symmetric_eigen(congruent(information, root_));
  if (!eigen) return;
  Eigen::VectorXd along = eigen->vectors.transpose() * (root_.transpose() * gradient);
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    const double share = std::clamp(eigen->values[i], 0.0, 1.0);
    found_ += along[i] * along[i];
    expected_ += share * (1 - share);
    if (share > kNothing) {
      chi_square_.sum += along[i] * along[i] / share;
      chi_square_.degrees += 1;
    }
    along[i] /= std::sqrt(std::max(1 - share, kLeastLeft));
  }
  const Eigen::VectorXd spread = eigen->vectors * along;
  scatter_ += spread * spread.transpose();
  ++views_;
}

std::optional<Eigen::MatrixXd> Contradiction::covariance() const {
  constexpr double kMean = 2;
  if (!(expected_ > 0)) return std::nullopt;
  const Eigen::MatrixXd mean =
      Eigen::MatrixXd::Identity(root_.rows(), root_.cols()) * (found_ / expected_);
  const Eigen::MatrixXd all = (views_ * scatter_ + kMean * mean) / (views_ + kMean);
  return congruent(all, root_.transpose());
}

}  // namespace calvin
