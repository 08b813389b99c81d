// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Eigen's products and decompositions of dense matrices, compiled here alone.

#include "calvin/geometry/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace calvin {

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  // The packing for Eigen's fast product takes longer than a small one itself.
  constexpr Eigen::Index kSmall = 64;
  if (a.rows() + a.cols() + b.cols() < kSmall) return a.lazyProduct(b);
  return a * b;
}

Eigen::MatrixXd congruent(const Eigen::MatrixXd& m, const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd right = product(m, a);
  return product(a.transpose(), right);
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& m, const Eigen::MatrixXd& right) {
  return Eigen::LDLT<Eigen::MatrixXd>(m).solve(right);
}

std::optional<Eigen::MatrixXd> solve_definite(const Eigen::MatrixXd& m,
                                              const Eigen::MatrixXd& right, double least_pivot) {
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(m);
  if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > least_pivot)) {
    return std::nullopt;
  }
  return ldlt.solve(right);
}

Eigen::MatrixXd orthogonal_complement(const Eigen::MatrixXd& m) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(m);
  Eigen::MatrixXd all = Eigen::MatrixXd::Identity(m.rows(), m.rows());
  all.applyOnTheLeft(qr.householderQ());
  return all.rightCols(m.rows() - m.cols());
}

}  // namespace calvin
