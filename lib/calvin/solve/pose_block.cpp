// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/pose_block.hpp"

#include <cmath>

namespace calvin {

void set_normal(const Eigen::Ref<const Eigen::MatrixXd>& rows, Eigen::Ref<Eigen::MatrixXd> normal) {
  normal.setZero();
  normal.selfadjointView<Eigen::Lower>().rankUpdate(rows);
}

std::optional<Matrix6> pose_factor(const Matrix6& block, double lambda) {
  Matrix6 l = Matrix6::Zero();
  for (int j = 0; j < 6; ++j) {
    double pivot = block(j, j) * (1 + lambda);
    for (int k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
    if (!(pivot > 0)) return std::nullopt;
    l(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < 6; ++i) {
      double sum = block(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
      l(i, j) = sum / l(j, j);
    }
  }
  return l;
}

void solve_lower(const Matrix6& factor, Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> x) {
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    double* column = x.col(c).data();
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < i; ++k) column[i] -= factor(i, k) * column[k];
      column[i] /= factor(i, i);
    }
  }
}

void solve_upper(const Matrix6& factor, Vector6& x) {
  for (int i = 5; i >= 0; --i) {
    for (int k = i + 1; k < 6; ++k) x[i] -= factor(k, i) * x[k];
    x[i] /= factor(i, i);
  }
}

}  // namespace calvin
