// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The one instantiation of Eigen's eigenvalue solver for small symmetric matrices.

#include "calvin/geometry/symmetric.hpp"

#include <Eigen/Eigenvalues>

namespace calvin {

std::optional<SymmetricEigen> symmetric_eigen(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  if (eigen.info() != Eigen::Success) return std::nullopt;
  return SymmetricEigen{eigen.eigenvalues(), eigen.eigenvectors()};
}

}  // namespace calvin
