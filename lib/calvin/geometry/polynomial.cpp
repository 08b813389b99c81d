// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/geometry/polynomial.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace calvin {

double smallest_positive_root(std::span<const double> coefficients) {
  auto degree = static_cast<Eigen::Index>(coefficients.size()) - 1;
  while (degree > 0 && std::abs(coefficients[degree]) < 1e-300) --degree;
  double best = std::numeric_limits<double>::infinity();
  if (degree < 1) return best;

  // Eigenvalues of the companion matrix of the reversed polynomial are 1/s: a tiny leading
  // coefficient then gives a tiny eigenvalue instead of an overflow.
  if (std::abs(coefficients[0]) < 1e-300) return best;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  for (Eigen::Index i = 0; i < degree; ++i)
    companion(0, i) = -coefficients[i + 1] / coefficients[0];
  for (Eigen::Index i = 1; i < degree; ++i) companion(i, i - 1) = 1;
  if (!companion.allFinite()) return best;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(companion, false);
  if (solver.info() != Eigen::Success) return best;
  for (const std::complex<double>& inverse : solver.eigenvalues()) {
    const bool real = std::abs(inverse.imag()) <= 1e-9 * std::abs(inverse);
    if (real && inverse.real() > 1e-300) best = std::min(best, 1 / inverse.real());
  }
  return best;
}

}  // namespace calvin
