// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Gradients of single views, each whitened by what all views say.

#include "calvin/solve/judge/contradiction.hpp"

#include <cmath>

#include "calvin/geometry/dense.hpp"

namespace calvin {

double ChiSquare::deviations() const {
  if (!(degrees > 0)) return 0;
  const double width = 2 / (9 * degrees);
  return (std::cbrt(ratio()) - (1 - width)) / std::sqrt(width);
}

Contradiction::Contradiction(const Eigen::MatrixXd& covariance)
    : root_(root_of(covariance)),
      scatter_(Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols())) {}

ViewShare Contradiction::share(const Eigen::MatrixXd& information,
                               const Eigen::VectorXd& gradient) const {
  return {root_, information, gradient};
}

void Contradiction::add(const ViewShare& view) {
  if (!view.valid()) return;
  found_ += view.gradient().squaredNorm();
  expected_ += view.information().trace() - view.information().squaredNorm();
  chi_square_.sum += view.squares();
  chi_square_.degrees += view.directions();
  scatter_ += view.unabsorbed() * view.unabsorbed().transpose();
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
