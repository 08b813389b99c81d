// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A damped step of an arrowhead problem. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/solve/linear/arrowhead.hpp"

namespace calvin {

struct ArrowStep {
  Eigen::VectorXd move;  // of the shared unknowns
  double predicted = 0;  // the decrease of the cost, at least 0
};

// The step by which the linearised problem is least where every diagonal element of the normal
// equations is multiplied by 1 + lambda, the shared unknowns moving in the span of `basis` only.
// `blocks` takes the steps of the small blocks, each with kPose places. Absent where the equations
// are not positive definite.
[[nodiscard]] std::optional<ArrowStep> arrow_step(const ArrowEquations& equations,
                                                  ArrowElimination& elimination,
                                                  const Eigen::MatrixXd& basis, double lambda,
                                                  std::vector<double>& blocks);

}  // namespace calvin
