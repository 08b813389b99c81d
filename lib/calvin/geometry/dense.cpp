// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Eigen's products and decompositions of dense matrices, compiled here alone.

#include "calvin/geometry/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace calvin {

namespace {

// Whether a matrix is so small that the packing for Eigen's fast product would take longer than a
// product with it.
bool is_small(Eigen::Index rows, Eigen::Index columns) {
  constexpr Eigen::Index kFew = 16;
  return rows <= kFew && columns <= kFew;
}

// a b for small ones: whole columns of a, four at a time.
Eigen::MatrixXd small_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  constexpr Eigen::Index kAtOnce = 4;
  const Eigen::Index n = a.rows();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    double* to = out.data() + j * n;
    Eigen::Index k = 0;
    for (; k + kAtOnce <= b.rows(); k += kAtOnce) {
      const double* from = a.data() + k * n;
      const double* factors = b.data() + j * b.rows() + k;
      for (Eigen::Index i = 0; i < n; ++i) {
        to[i] += factors[0] * from[i] + factors[1] * from[i + n] + factors[2] * from[i + 2 * n] +
                 factors[3] * from[i + 3 * n];
      }
    }
    for (; k < b.rows(); ++k) {
      for (Eigen::Index i = 0; i < n; ++i) to[i] += b(k, j) * a(i, k);
    }
  }
  return out;
}

}  // namespace

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  constexpr Eigen::Index kSmall = 64;  // likewise, of all that is multiplied
  if (a.rows() + a.cols() + b.cols() < kSmall) return small_product(a, b);
  if (!is_small(b.rows(), b.cols())) return a * b;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(a.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index k = 0; k < b.rows(); ++k) out.col(j) += b(k, j) * a.col(k);
  }
  return out;
}

Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (!is_small(a.cols(), b.cols())) return a.transpose() * b;
  Eigen::MatrixXd out(a.cols(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.cols(); ++i) out(i, j) = a.col(i).dot(b.col(j));
  }
  return out;
}

Eigen::MatrixXd congruent(const Eigen::MatrixXd& m, const Eigen::MatrixXd& a) {
  return transposed_product(a, product(m, a));
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

LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& right,
                           std::optional<double> threshold) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a.rows(), a.cols());
  if (threshold) qr.setThreshold(*threshold);
  qr.compute(a);
  return {qr.solve(right), qr.rank()};
}

Eigen::MatrixXd orthogonal_complement(const Eigen::MatrixXd& m) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(m);
  Eigen::MatrixXd all = Eigen::MatrixXd::Identity(m.rows(), m.rows());
  all.applyOnTheLeft(qr.householderQ());
  return all.rightCols(m.rows() - m.cols());
}

std::vector<double> row_major(const Eigen::MatrixXd& m) {
  std::vector<double> all;
  all.reserve(static_cast<std::size_t>(m.size()));
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    for (Eigen::Index c = 0; c < m.cols(); ++c) all.push_back(m(r, c));
  }
  return all;
}

}  // namespace calvin
