// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Small symmetric systems in parameters of very different sizes. Internal.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace calvin {

// The least pivot of an information matrix scaled to a diagonal of 1: below it an unknown cannot be
// told from the others in double precision.
inline constexpr double kLeastPivot = 1e-14;

// The X with m X = right for a positive definite m, factorised after scaling to a unit diagonal, so
// that px and powers of a radius weigh alike. Absent where a pivot of the scaled matrix is not
// above `least_pivot`.
[[nodiscard]] std::optional<Eigen::MatrixXd> scaled_solve(const Eigen::MatrixXd& m,
                                                          const Eigen::MatrixXd& right,
                                                          double least_pivot);

// B^T m B for the symmetric m whose lower triangle is given. A function of its own, as Eigen's
// products take long to compile.
[[nodiscard]] Eigen::MatrixXd restrict_to(const Eigen::MatrixXd& basis,
                                          const Eigen::MatrixXd& lower);

}  // namespace calvin
