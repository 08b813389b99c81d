// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board of a joint solve as the frame of the rig: where it was, and how well that is known beside
// the places of the cameras. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/rig.hpp"
#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/rig/joint/rig_solver.hpp"

namespace calvin::rig {

struct BoardFrame {
  SE3 rig_from_board;
  // d of rig_from_board, as retract() in solve/residuals/bundle_problem.hpp has it, is `by_places`
  // times that of the places of all cameras but the first, and something beside: of the covariance
  // `own`, and `with_places` with those places (a column for each of its six).
  Eigen::MatrixXd by_places;
  Eigen::MatrixXd with_places;
  Eigen::MatrixXd own;
};

// The pose, of those in use, of which pictures were taken next to the time that `world` asks for.
[[nodiscard]] std::optional<std::size_t> pose_at(const RigWorld& world,
                                                 const std::vector<BoardView>& views,
                                                 const std::vector<RigCameraViews>& seen,
                                                 const RigSolver& solver);

// At the optimum of `solver`. `known` is what is known of the places and intrinsics, over a table
// of these cameras; `variance`: of the residuals, px^2. Absent where corners do not determine it.
[[nodiscard]] std::optional<BoardFrame> board_frame(std::size_t pose, RigSolver& solver,
                                                    const ParameterTable& table,
                                                    const PlaceCovariance& known, double variance);

// The covariance of the places and the board together, from that of the places.
[[nodiscard]] Eigen::MatrixXd with_board(const Eigen::MatrixXd& of_places, const BoardFrame& board);

}  // namespace calvin::rig
