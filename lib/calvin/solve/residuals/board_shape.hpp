// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The shape of a board as unknowns of a solve: its modes of displacement. Internal.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/parameters/parameter_order.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/grid.hpp"
#include "calvin/target/measured/board_measurement.hpp"

namespace calvin {

// How the shape of a board may differ from the printed one: point i of Board::points() moves by
// coefficient[m] * displacement[i * modes + m], in m. The modes are in the order of BoardUnknowns:
// the curvatures are those of BoardWarp (m), the aspect has no unit.
struct BoardShape {
  std::size_t modes = 0;
  std::vector<Eigen::Vector3d> displacement;
  std::vector<double> prior;  // per mode, 1 sigma: holds modes that the views do not determine
  BoardUnknowns unknowns;     // which modes these are
  std::optional<Grid> grid;   // the points of the board as printed, where they are one

  // What is known of the points where their offsets are unknowns of their own, curvatures and all;
  // else null. `start` is how the board is bent as far as others know.
  std::shared_ptr<const BoardMeasurement> offsets;
  std::optional<BoardWarp> start;
};

// What the options ask for, about a board that is flat as it was printed.
[[nodiscard]] BoardShape make_shape(const Board& board, const SolveOptions& options);

// The control points of a board with this warp, m, board frame.
[[nodiscard]] std::vector<Eigen::Vector3d> bent_points(const Board& board, const BoardWarp& warp);

}  // namespace calvin
