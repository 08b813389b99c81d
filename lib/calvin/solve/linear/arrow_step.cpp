// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The shared unknowns by the Schur complement, then every small block by what they do.

#include "calvin/solve/linear/arrow_step.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

// The diagonal of the normal equations of the shared unknowns, in the directions of the basis.
Eigen::VectorXd shared_diagonal(const ArrowEquations& equations, const Eigen::MatrixXd& basis) {
  const Eigen::Index n = basis.rows();
  Eigen::MatrixXd normal(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) normal(i, j) = equations.shared(i, j);
  }
  return restrict_to(basis, normal).diagonal();
}

// What the blocks' steps add to the decrease.
double step_blocks(const ArrowEquations& equations, const ArrowElimination& elimination,
                   const Eigen::VectorXd& move, double lambda, double predicted,
                   std::vector<double>& blocks) {
  const ArrowLayout& layout = equations.layout();
  blocks.resize(ArrowLayout::kPose * layout.blocks());
  for (std::size_t block = 0; block < layout.blocks(); ++block) {
    double* d = &blocks[ArrowLayout::kPose * block];
    elimination.block_step(block, move, d);
    const auto n = static_cast<std::size_t>(layout.size(block));
    const double* own = equations.own(block);
    const double* cross = equations.cross(block);
    for (std::size_t i = 0; i < n; ++i) {
      predicted += d[i] * (lambda * own[i * n + i] * d[i] - cross[i * layout.stride()]);
    }
  }
  return predicted;
}

}  // namespace

std::optional<ArrowStep> arrow_step(const ArrowEquations& equations, ArrowElimination& elimination,
                                    const Eigen::MatrixXd& basis, double lambda,
                                    std::vector<double>& blocks) {
  if (!elimination.eliminate(equations, lambda)) return std::nullopt;
  const Eigen::VectorXd damping = shared_diagonal(equations, basis);
  Eigen::MatrixXd s = restrict_to(basis, elimination.schur());
  s.diagonal() += lambda * damping;
  const auto step =
      scaled_solve(s, -basis.transpose().lazyProduct(elimination.reduced_gradient()), 0);
  if (!step) return std::nullopt;
  ArrowStep result{basis.lazyProduct(step->col(0)), 0};
  double predicted = lambda * step->col(0).dot(damping.cwiseProduct(step->col(0)));
  for (int i = 0; i < result.move.size(); ++i) {
    predicted -= equations.shared_gradient(i) * result.move[i];
  }
  predicted = step_blocks(equations, elimination, result.move, lambda, predicted, blocks);
  if (!std::isfinite(predicted)) return std::nullopt;
  result.predicted = std::max(predicted, 0.0);
  return result;
}

}  // namespace calvin
