// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pose of a board by what it was eliminated with: d = -H_bb^-1 (H_bp d_p + H_bi d_i) and the
// noise of its own corners, which knows nothing of that.

#include "calvin/rig/joint/board_frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/pose_unknowns.hpp"

namespace calvin::rig {

namespace {

// ns from the time that is asked for; of the first instant and the last one what is less for those
// that come earlier and later.
double away_from(const RigWorld& world, std::uint64_t timestamp) {
  constexpr double kNanosecond = 1e-9;  // s
  const double time = kNanosecond * static_cast<double>(timestamp);
  if (!world.time) return time;
  return std::isinf(*world.time) ? -time : std::abs(time - *world.time);
}

}  // namespace

std::optional<std::size_t> pose_at(const RigWorld& world, const std::vector<BoardView>& views,
                                   const std::vector<RigCameraViews>& seen,
                                   const RigSolver& solver) {
  double least = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> nearest;
  const std::vector<PlacedView>& placed = solver.places().views;
  for (std::size_t p = 0; p < placed.size(); ++p) {
    if (!solver.is_used(p)) continue;
    const RigView& of = views[placed[p].view].of;
    const double away = away_from(world, seen[of.camera].views[of.view].observation.timestamp);
    if (nearest && !(away < least)) continue;
    least = away;
    nearest = placed[p].pose;
  }
  return nearest;
}

std::optional<BoardFrame> board_frame(std::size_t pose, RigSolver& solver,
                                      const ParameterTable& table, const PlaceCovariance& known,
                                      double variance) {
  const auto equations = solver.pose_equations(pose, table);
  if (!equations) return std::nullopt;
  const auto inverse = solve_definite(equations->own, Eigen::MatrixXd::Identity(kPose, kPose), 0);
  if (!inverse) return std::nullopt;
  const Eigen::MatrixXd by_shared = -product(*inverse, equations->by_shared);
  const Eigen::Index places = known.of_places.rows();
  const Eigen::Index intrinsics = known.of_intrinsics.rows();
  BoardFrame board;
  board.rig_from_board = solver.places().rig_from_board[pose];
  board.by_places = by_shared.rightCols(places);
  const Eigen::MatrixXd by_intrinsics = by_shared.leftCols(intrinsics).transpose();
  board.with_places = product(known.with_intrinsics, by_intrinsics);
  board.own = variance * *inverse + congruent(known.of_intrinsics, by_intrinsics);
  return board;
}

Eigen::MatrixXd with_board(const Eigen::MatrixXd& of_places, const BoardFrame& board) {
  const Eigen::Index places = of_places.rows();
  const Eigen::MatrixXd together =
      product(of_places, board.by_places.transpose()) + board.with_places;
  const Eigen::MatrixXd mixed = product(board.by_places, board.with_places);
  Eigen::MatrixXd all(places + kPose, places + kPose);
  all.topLeftCorner(places, places) = of_places;
  all.topRightCorner(places, kPose) = together;
  all.bottomLeftCorner(kPose, places) = together.transpose();
  all.bottomRightCorner(kPose, kPose) =
      congruent(of_places, board.by_places.transpose()) + mixed + mixed.transpose() + board.own;
  return all;
}

}  // namespace calvin::rig
