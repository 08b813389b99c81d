// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One view beside all views: its share of what they say, and what is left without it. Internal.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace calvin {

// A view in units of what all views say of the directions, in which their covariance is 1: its
// information A, whose eigenvalues are 0..1, and its gradient z at the optimum of all of them.
class ViewShare {
 public:
  // `root` is a W with W W^T the covariance of the directions by all views; information and
  // gradient are the reduced ones of the view, over the variance of a residual.
  ViewShare(const Eigen::MatrixXd& root, const Eigen::MatrixXd& information,
            const Eigen::VectorXd& gradient);

  // False where a number is not finite; the others are nothing then.
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] const Eigen::MatrixXd& information() const { return information_; }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }

  // z^T A^-1 z over the directions of which the view tells something, and their number.
  [[nodiscard]] double squares() const { return squares_; }
  [[nodiscard]] double directions() const { return directions_; }

  // (1 - A)^-1/2 z. The fit to all views has absorbed a part of each: what is left of a gradient
  // has the covariance A - A A, and spreads so as if nothing were absorbed (R. Bell, D. McCaffrey,
  // Survey Methodology 28(2), 2002). A view that decides alone tells nothing of its error: a share
  // of more than .98 counts as that.
  [[nodiscard]] const Eigen::VectorXd& unabsorbed() const { return unabsorbed_; }
  // (1 - A)^-1 z: the step from the optimum of all views to that of the others. Absent where the
  // others do not tell every direction.
  [[nodiscard]] const std::optional<Eigen::VectorXd>& without() const { return without_; }

 private:
  [[nodiscard]] bool tells_all();
  void add_powers(double norm);
  [[nodiscard]] bool decompose();

  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
  Eigen::VectorXd unabsorbed_;
  std::optional<Eigen::VectorXd> without_;
  double squares_ = 0;
  double directions_ = 0;
  bool valid_ = false;
};

// The W with W W^T = m, for a symmetric m whose diagonal is positive.
[[nodiscard]] Eigen::MatrixXd root_of(const Eigen::MatrixXd& m);

}  // namespace calvin
