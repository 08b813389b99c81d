// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Eigenvalues of small symmetric matrices. In a function of its own, as Eigen's solvers take long
// to compile and as long again for every size. Internal.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace calvin {

struct SymmetricEigen {
  Eigen::VectorXd values;   // increasing
  Eigen::MatrixXd vectors;  // a column each, of length 1
};

// Reads the lower triangle. Absent where a number is not finite or the iteration does not end.
[[nodiscard]] std::optional<SymmetricEigen> symmetric_eigen(const Eigen::MatrixXd& matrix);

}  // namespace calvin
