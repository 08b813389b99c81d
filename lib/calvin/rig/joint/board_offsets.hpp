// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where boards are on the bodies that they are fixed to, as unknowns of the least squares of a rig.
// Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/board_views.hpp"
#include "calvin/rig/joint/rig_solver.hpp"

namespace calvin::rig {

struct BoardOffsets {
  std::vector<std::size_t> boards;  // BoardView::own_board, of all that do not define their body
  // d of each as retract() in solve/residuals/bundle_problem.hpp has it, for body_from_board: to
  // the optimum; their covariance; and the places of all cameras but the first by them.
  Eigen::VectorXd step;
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd places_by_offset;
};

// One step of Gauss-Newton from the optimum that `solver` has found for bodies as the labellings of
// `views` have them. Absent where every board is a body of its own, and where the views leave open
// how boards are fixed to each other.
[[nodiscard]] std::optional<BoardOffsets> board_offsets(const std::vector<BoardView>& views,
                                                        const std::vector<Camera>& cameras,
                                                        RigSolver& solver, double variance);

}  // namespace calvin::rig
