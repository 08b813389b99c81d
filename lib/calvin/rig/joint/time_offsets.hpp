// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Clocks of cameras that are apart: the time offset of each is one more unknown of the least
// squares, by how fast corners move in the picture. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/board_views.hpp"
#include "calvin/rig/joint/rig_solver.hpp"

namespace calvin::rig {

struct TimeOffsets {
  // Of each camera, s: so much later than its timestamps say, against those of the first one, its
  // pictures were taken. 0 where nothing that it saw was moving.
  std::vector<double> seconds;
  std::vector<double> sigma;  // s; 0 where nothing is known
  // s^2, of all cameras; and how the places of all cameras but the first move with offsets, per s:
  // d of each as retract() in solve/residuals/bundle_problem.hpp has it.
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd places_by_offset;
};

// One step of Gauss-Newton from the optimum that `solver` has found, all places with it: the
// columns of the offsets are what is left of the ways of corners in a moment when everything else
// has followed them. `variance` is that of the solver, px^2. Absent where no corners were moving,
// and where they leave an offset open.
[[nodiscard]] std::optional<TimeOffsets> time_offsets(std::size_t cameras,
                                                      const std::vector<BoardView>& views,
                                                      RigSolver& solver, double variance);

}  // namespace calvin::rig
