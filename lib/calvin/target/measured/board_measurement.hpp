// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// BoardMeasurement: where the control points of one sheet are, measured by cameras. Internal.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// By what a view is known again: the mean of its control points and their spread, px.
struct ViewMark {
  Pixel mean;
  Pixel spread;
};

// Of an observation with control points.
[[nodiscard]] ViewMark mark_of(const Observation& observation);

// Whether two marks are of one view: corners that are refined anew move by less than noise does.
[[nodiscard]] bool same_view(const ViewMark& a, const ViewMark& b);

// How far each control point of a sheet is from where it was printed: a Gaussian. The offsets are
// no shift, turn, scale, shear or tilt of the board, which poses and focal lengths explain; its
// curvatures are among them.
struct BoardMeasurement {
  Board board;
  std::vector<Eigen::Vector3d> offsets;  // m, board frame, in the order of Board::points()
  Eigen::MatrixXd covariance;            // m^2, over x y z of one point after the other
  std::vector<ViewMark> views;           // which it was made of
};

// A covariance of many numbers by few: each has its own variance beside what it has in common with
// others, diag(own) + modes modes^T.
struct CompactCovariance {
  Eigen::VectorXd own;
  Eigen::MatrixXd modes;  // a column each

  [[nodiscard]] Eigen::MatrixXd full() const;
};

// The one of `modes` columns whose diagonal is that of `covariance` and which is the nearest of
// these by principal factors: H. Harman, Modern Factor Analysis, 1976.
[[nodiscard]] CompactCovariance compact(const Eigen::MatrixXd& covariance, int modes);

// kUnsupported for a board that has too few points or rows to have offsets, or too many.
[[nodiscard]] Status can_be_measured(const Board& board);

// What is known of a board that nobody has measured: offsets of 0, with sigmas that are wide for
// any board that was made with care. Errors are those of can_be_measured().
[[nodiscard]] Result<BoardMeasurement> unmeasured(const Board& board);

}  // namespace calvin
