// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What small problems of minimise() have in common: one vector of unknowns, and normal equations
// that are a dense matrix.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"

namespace calvin {

// The normal equations at a point: J^T J, J^T r and the sum of squares r^T r.
struct NormalEquations {
  Eigen::VectorXd x;
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;
  double cost = 0;
};

// A Problem of lm.hpp but for `bool linearise(NormalEquations& at) const` of Derived, which fills
// in all but x, and is false where there is nothing to fill in. Derived begins with x at current_.
template <typename Derived>
class DenseProblem {
 public:
  [[nodiscard]] bool begin() { return derived().linearise(current_); }
  [[nodiscard]] double cost() const { return current_.cost; }
  [[nodiscard]] std::optional<double> propose(double lambda) {
    Eigen::MatrixXd damped = current_.normal;
    damped.diagonal() *= 1 + lambda;
    const Eigen::VectorXd step = -solve_symmetric(damped, current_.gradient);
    if (!step.allFinite()) return std::nullopt;
    trial_.x = current_.x + step;
    const Eigen::VectorXd diagonal = current_.normal.diagonal();
    return std::max(0.0, step.dot(lambda * diagonal.cwiseProduct(step) - current_.gradient));
  }
  [[nodiscard]] std::optional<double> evaluate_trial() {
    if (!derived().linearise(trial_)) return std::nullopt;
    return trial_.cost;
  }
  void accept() { std::swap(current_, trial_); }
  void accept_unseen(double predicted) {
    current_.x = trial_.x;
    current_.cost = std::max(0.0, current_.cost - predicted);
  }

 protected:
  DenseProblem() = default;

  NormalEquations current_;

 private:
  [[nodiscard]] const Derived& derived() const { return static_cast<const Derived&>(*this); }

  NormalEquations trial_;
};

}  // namespace calvin
