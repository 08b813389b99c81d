// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is done with dense matrices whose size is known at run time only. In functions of their own,
// as Eigen's products and decompositions take seconds to compile in every file that has one.
// Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace calvin {

// a b
[[nodiscard]] Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// a^T b
[[nodiscard]] Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& a,
                                                 const Eigen::MatrixXd& b);

// a^T m a
[[nodiscard]] Eigen::MatrixXd congruent(const Eigen::MatrixXd& m, const Eigen::MatrixXd& a);

// The X with m X = right, for a symmetric m that is positive or negative semidefinite, by L D L^T
// with pivots. Reads the lower triangle of m.
[[nodiscard]] Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& m,
                                              const Eigen::MatrixXd& right);

// The same for a positive definite m. Absent where a pivot is not above `least_pivot`.
[[nodiscard]] std::optional<Eigen::MatrixXd> solve_definite(const Eigen::MatrixXd& m,
                                                            const Eigen::MatrixXd& right,
                                                            double least_pivot);

struct LeastSquares {
  Eigen::MatrixXd x;      // a column for each of the right sides
  Eigen::Index rank = 0;  // of a
};

// The x of the least |a x - right|, by Householder's reflections with pivots; what the rows leave
// open is 0. A pivot below `threshold` times the largest one counts as none; by default Eigen's.
[[nodiscard]] LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& right,
                                         std::optional<double> threshold = {});

// An orthonormal basis of all that is orthogonal to the columns of `m`, which are independent: as
// many columns as m has rows more than columns.
[[nodiscard]] Eigen::MatrixXd orthogonal_complement(const Eigen::MatrixXd& m);

// The elements, row after row, as messages and files have them.
[[nodiscard]] std::vector<double> row_major(const Eigen::MatrixXd& m);

}  // namespace calvin
