// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What of a board's shape a solve estimates beside the camera. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// How the shape of a board may differ from the printed one: the point with id i moves by
// coefficient[m] * displacement[i * modes + m], in m. The modes, in this order: the two curvatures
// of BoardWarp (m), the aspect less 1, and an orthonormal basis of what corners may do (m).
struct BoardShape {
  std::size_t modes = 0;
  std::vector<Eigen::Vector3d> displacement;
  std::vector<double> prior;  // per mode: what keeps it where the views tell nothing of it, 1 sigma
  bool warp = false;
  bool aspect = false;
  std::size_t offsets = 0;  // the number of their modes

  [[nodiscard]] std::size_t first_offset() const { return modes - offsets; }
};

// Of a board that lies flat as it was printed, as far as the options ask. The offsets of single
// corners are those that are no shift, turn, scale or shear of the board, no tilt of it, and no
// curvature: poses, focal lengths and the other modes have these.
[[nodiscard]] BoardShape make_shape(const Board& board, const SolveOptions& options);

// The control points of a board that is bent so, m, board frame.
[[nodiscard]] std::vector<Eigen::Vector3d> bent_points(const Board& board, const BoardWarp& warp);

}  // namespace calvin
