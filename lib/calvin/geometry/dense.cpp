// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Eigen's products and decompositions of dense matrices, compiled here alone.

#include "calvin/geometry/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace calvin {

namespace {

// to += a b, each of `n` numbers, for four columns of a at a time.
void add_columns(const double* a, Eigen::Index n, const double* b, double* __restrict to) {
  for (Eigen::Index i = 0; i < n; ++i) {
    to[i] += a[i] * b[0] + a[n + i] * b[1] + a[2 * n + i] * b[2] + a[3 * n + i] * b[3];
  }
}

Eigen::MatrixXd small_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::Index n = a.rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    double* to = &result(0, j);
    Eigen::Index k = 0;
    for (; k + 4 <= a.cols(); k += 4) add_columns(&a(0, k), n, &b(k, j), to);
    for (; k < a.cols(); ++k) {
      for (Eigen::Index i = 0; i < n; ++i) to[i] += a(i, k) * b(k, j);
    }
  }
  return result;
}

}  // namespace

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  // The packing for Eigen's fast product takes longer than a small one itself.
  constexpr Eigen::Index kSmall = 64;
  const bool empty = a.size() == 0 || b.size() == 0;
  if (!empty && a.rows() + a.cols() + b.cols() < kSmall) return small_product(a, b);
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
