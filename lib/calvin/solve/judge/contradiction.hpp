// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether views contradict each other, and the covariance that follows from how they scatter.
// Internal.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "calvin/solve/judge/view_share.hpp"

namespace calvin {

// Standard deviations; one test in a hundred exceeds it by noise.
inline constexpr double kSignificant = 2.33;

// A chi^2 statistic: a sum of squares that for noise alone is `degrees`, give or take
// sqrt(2 degrees).
struct ChiSquare {
  double sum = 0;
  double degrees = 0;

  // The excess in standard deviations, by the cube root that makes chi^2 nearly normal (E. Wilson,
  // M. Hilferty, PNAS 17, 1931).
  [[nodiscard]] double deviations() const;
  // The variance over that of noise: 1 for noise.
  [[nodiscard]] double ratio() const { return degrees > 0 ? sum / degrees : 1; }
};

// What single views say of the directions, in units of what all of them say.
class Contradiction {
 public:
  // `covariance` is that of the directions by all views, were their residuals noise.
  explicit Contradiction(const Eigen::MatrixXd& covariance);

  // The share of a view, of its reduced information and gradient at the optimum of all, over the
  // variance of a residual.
  [[nodiscard]] ViewShare share(const Eigen::MatrixXd& information,
                                const Eigen::VectorXd& gradient) const;
  void add(const ViewShare& view);

  // The W of ViewShare.
  [[nodiscard]] const Eigen::MatrixXd& root() const { return root_; }

  // The degrees are those of all views, of which the fit has absorbed as many as it has directions.
  [[nodiscard]] const ChiSquare& chi_square() const { return chi_square_; }

  // The covariance of the directions by the scatter of the views, whatever makes them scatter:
  // noise that is larger in some, bends, motion. Few views do not tell every direction: what all
  // directions scatter in the mean counts as two views more. Absent where nothing is left to tell.
  [[nodiscard]] std::optional<Eigen::MatrixXd> covariance() const;

 private:
  Eigen::MatrixXd root_;
  Eigen::MatrixXd scatter_;
  double views_ = 0;
  double found_ = 0;
  double expected_ = 0;
  ChiSquare chi_square_;
};

}  // namespace calvin
