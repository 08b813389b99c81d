// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The shape of a board as unknowns of a solve: its modes of displacement. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/parameters/parameter_order.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// How the shape of a board may differ from the printed one: point i of Board::points() moves by
// coefficient[m] * displacement[i * modes + m], in m. The modes are in the order of BoardUnknowns:
// the curvatures are those of BoardWarp (m), the aspect has no unit, and those of single corners
// are an orthonormal basis of what corners may do (m).
struct BoardShape {
  std::size_t modes = 0;
  std::vector<Eigen::Vector3d> displacement;
  std::vector<double> prior;  // per mode, 1 sigma: holds modes that the views do not determine
  BoardUnknowns unknowns;     // which modes these are
};

// The modes that the options ask for, about a board that is flat as it was printed. The modes of
// single corners are orthogonal to every shift, turn, scale, shear, tilt and curvature of the
// board, which poses, focal lengths and the other modes explain.
[[nodiscard]] BoardShape make_shape(const Board& board, const SolveOptions& options);

// The control points of a board with this warp, m, board frame.
[[nodiscard]] std::vector<Eigen::Vector3d> bent_points(const Board& board, const BoardWarp& warp);

}  // namespace calvin
