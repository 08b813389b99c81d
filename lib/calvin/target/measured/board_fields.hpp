// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fields of displacements over the control points of a board. Internal.
#pragma once

#include <Eigen/Core>

#include "calvin/target/board.hpp"

namespace calvin {

// Displacements, x y z of one control point after the other; x and y run from -1 to 1 over the
// extent of the points, as in BoardWarp. Two columns: (0, 0, 1 - x^2) and (0, 0, 1 - y^2).
[[nodiscard]] Eigen::MatrixXd curvature_fields(const Board& board);

// (0, (y + 1) / 2 height, 0): rows that are farther apart than columns, by the aspect less 1.
[[nodiscard]] Eigen::VectorXd aspect_field(const Board& board);

// An orthonormal basis, in columns, of the displacements that are no shift, turn, scale, shear or
// tilt of the board.
[[nodiscard]] Eigen::MatrixXd offset_basis(const Board& board);

// Whether a board has enough points, in enough rows, to have a shape of its own.
[[nodiscard]] bool has_shape(const Board& board);

// 1 sigma of a curvature, m, wide for any board that was made with care.
[[nodiscard]] double wide_curvature(const Board& board);

}  // namespace calvin
