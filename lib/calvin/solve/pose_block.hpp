// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Normal equations and the 6x6 blocks of poses in them. Compiled once for all models. Internal.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace calvin {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// J^T J into the lower triangle of `normal`; `rows` is J^T, a column per residual.
void set_normal(const Eigen::Ref<const Eigen::MatrixXd>& rows, Eigen::Ref<Eigen::MatrixXd> normal);

// The lower L with L L^T = block, whose diagonal is first multiplied by 1 + lambda; the lower
// triangle is read. Absent where the block is not positive definite.
[[nodiscard]] std::optional<Matrix6> pose_factor(const Matrix6& block, double lambda);

// L^-1 x in place, for every column.
void solve_lower(const Matrix6& factor, Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> x);

// L^-T x in place.
void solve_upper(const Matrix6& factor, Vector6& x);

}  // namespace calvin
