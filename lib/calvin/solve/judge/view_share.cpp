// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Functions of a view's share of the information: power series where it is small, as mostly, and
// eigenvectors where it is not.

#include "calvin/solve/judge/view_share.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin {

Eigen::MatrixXd root_of(const Eigen::MatrixXd& m) {
  const Eigen::VectorXd scale = m.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const auto eigen = symmetric_eigen(inverse.asDiagonal() * m * inverse.asDiagonal());
  if (!eigen) return Eigen::MatrixXd::Zero(m.rows(), m.cols());
  return scale.asDiagonal() * eigen->vectors * eigen->values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

namespace {

// a^T m a for a symmetric m, of which the lower half is computed.
Eigen::MatrixXd whitened(const Eigen::MatrixXd& m, const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd right = product(m, a);
  Eigen::MatrixXd out(a.cols(), a.cols());
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = j; i < a.cols(); ++i) out(i, j) = out(j, i) = a.col(i).dot(right.col(j));
  }
  return out;
}

// m x for a symmetric m, whose columns lie together in memory as its rows do not.
void multiply(const Eigen::MatrixXd& m, const Eigen::VectorXd& x, Eigen::VectorXd& out) {
  for (Eigen::Index i = 0; i < x.size(); ++i) out[i] = m.col(i).dot(x);
}

}  // namespace

ViewShare::ViewShare(const Eigen::MatrixXd& root, const Eigen::MatrixXd& information,
                     const Eigen::VectorXd& gradient)
    : information_(whitened(information, root)), gradient_(root.transpose() * gradient) {
  // No eigenvalue is larger than the norm; beyond, the powers take longer than eigenvectors do.
  constexpr double kSmall = 0.8;
  const double norm = information_.norm();
  if (norm < kSmall && tells_all()) {
    add_powers(norm);
    valid_ = true;
  } else {
    valid_ = decompose();
  }
}

// The squares by a Cholesky factor L of the information: those of L^-1 z. False where the view
// tells nearly nothing of a direction.
bool ViewShare::tells_all() {
  constexpr double kNothing = 1e-9;
  const Eigen::Index n = gradient_.size();
  Eigen::MatrixXd l = information_;
  double squares = 0;
  Eigen::VectorXd whitened(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    double pivot = l(j, j);
    double along = gradient_[j];
    for (Eigen::Index k = 0; k < j; ++k) {
      pivot -= l(j, k) * l(j, k);
      along -= l(j, k) * whitened[k];
    }
    if (!(pivot > kNothing)) return false;
    const double scale = 1 / std::sqrt(pivot);
    whitened[j] = along * scale;
    squares += whitened[j] * whitened[j];
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double sum = l(i, j);
      for (Eigen::Index k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
      l(i, j) = sum * scale;
    }
  }
  squares_ = squares;
  directions_ = static_cast<double>(n);
  return true;
}

// The series of (1 - x)^-1/2 and (1 - x)^-1.
void ViewShare::add_powers(double norm) {
  constexpr double kNegligible = 1e-11;
  const double least = kNegligible * (1 - norm) * gradient_.norm();
  Eigen::VectorXd power = gradient_;
  Eigen::VectorXd before(power.size());
  Eigen::VectorXd sum = gradient_;
  unabsorbed_ = gradient_;
  double coefficient = 1;
  for (int k = 1; power.squaredNorm() > least * least; ++k) {
    power.swap(before);
    multiply(information_, before, power);
    coefficient *= (k - 0.5) / k;
    unabsorbed_ += coefficient * power;
    sum += power;
  }
  without_ = std::move(sum);
}

bool ViewShare::decompose() {
  constexpr double kNothing = 1e-10;
  constexpr double kLeastLeft = 0.02;
  const auto eigen = symmetric_eigen(information_);
  if (!eigen) return false;
  Eigen::VectorXd along = eigen->vectors.transpose() * gradient_;
  Eigen::VectorXd without = along;
  bool others_tell = true;
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    const double share = std::clamp(eigen->values[i], 0.0, 1.0);
    if (share > kNothing) {
      squares_ += along[i] * along[i] / share;
      directions_ += 1;
    }
    others_tell &= 1 - share > kNothing;
    without[i] /= std::max(1 - share, kNothing);
    along[i] /= std::sqrt(std::max(1 - share, kLeastLeft));
  }
  unabsorbed_ = eigen->vectors * along;
  if (others_tell) without_ = eigen->vectors * without;
  return true;
}

}  // namespace calvin
