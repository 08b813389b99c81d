// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Linear systems solved after scaling their diagonals to 1.

#include "calvin/solve/linear/scaled_solve.hpp"

#include "calvin/geometry/dense.hpp"

namespace calvin {

std::optional<Eigen::MatrixXd> scaled_solve(const Eigen::MatrixXd& m, const Eigen::MatrixXd& right,
                                            double least_pivot) {
  const Eigen::VectorXd diagonal = m.diagonal();
  if (!(diagonal.minCoeff() > 0) || !diagonal.allFinite()) return std::nullopt;
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * m * scale.asDiagonal();
  auto x = solve_definite(scaled, scale.asDiagonal() * right, least_pivot);
  if (!x) return std::nullopt;
  *x = scale.asDiagonal() * *x;
  if (!x->allFinite()) return std::nullopt;
  return x;
}

Eigen::MatrixXd restrict_to(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& lower) {
  Eigen::MatrixXd m = lower.selfadjointView<Eigen::Lower>();
  if (basis.rows() == basis.cols() && basis.isIdentity(0)) return m;
  return basis.transpose().lazyProduct(m.lazyProduct(basis).eval());
}

}  // namespace calvin
