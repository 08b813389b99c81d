// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What solve() returns: the calibration, what was left out, the verdict and the measured board.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/solve/misfit.hpp"

namespace calvin {

struct BoardMeasurement;

struct RejectedView {
  std::size_t index = 0;  // in the views given
  Reason reason = Reason::kOutlier;
};

struct RejectedCorner {
  std::size_t view = 0;  // index in the views given
  int id = 0;
};

// How much farther apart the rows of the board are than its columns.
struct BoardAspect {
  double value = 1;
  double sigma = 0;
};

// How far a corner is from where it was printed, and 1 sigma of it, m, board frame.
struct CornerOffset {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

struct Solution {
  // `created` is left empty. `views` lists the views used, in the order given; `covered` is the
  // convex hull of the corners used; `board` the boards of the views used, joined by ';'.
  Calibration calibration;
  std::vector<RejectedView> rejected;
  std::vector<RejectedCorner> rejected_corners;  // of views that are otherwise used
  int iterations = 0;                            // of all least-squares solves together
  // What the covariance and both promises do not hold, or hold at a great price.
  Misfit misfit;
  // Per view of calibration.views, in px^2 per corner: how far its corners are from where a camera
  // of all other views puts them, the 6 parameters of its pose allowed for; weighted, and to first
  // order. calibration.held_out_rms is their mean's root: information, it decides nothing.
  std::vector<double> held_out;
  // The board, where aspect and offsets were estimated or known. Offsets are in the order of
  // Board::points(); all together are no shift, turn, scale, shear, tilt or curvature of the board.
  std::optional<BoardAspect> board_aspect;
  std::vector<CornerOffset> corner_offsets;
  // Offsets and curvatures with their covariance, for the sessions that follow: what was known
  // before (SolveOptions::measured) and what these views say. Null where offsets were no unknowns.
  std::shared_ptr<const BoardMeasurement> measured;
  // Whether these views contradict what was known before: another board, or bent otherwise.
  bool other_board = false;
};

}  // namespace calvin
