// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What corners that are not where they were printed do to a camera. Internal.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calvin/solve/fit/camera_fit.hpp"

namespace calvin {

// The covariance of the directions where every corner of a board is off in its plane by 1 m (1
// sigma) along each axis, by itself, and in all views alike.
[[nodiscard]] Eigen::MatrixXd board_covariance(const Fit& fit, const BoardShape& shape,
                                               const Parameterization& parameterization);

// A fit to first order were every corner of the boards where all views together see it.
struct MeasuredBoard {
  std::vector<Eigen::VectorXd> gradients;  // of each view used, by the directions
  double left = 1;                         // of the residuals' squares
  double fitted = 0;                       // numbers that were fitted to them
};

// `inverse` is that of the information of the directions; `known` is what is known of a corner
// without the views, along the axes of its board, as the information of a residual of weight 1.
[[nodiscard]] MeasuredBoard with_measured_board(const Fit& fit, const BoardShape& shape,
                                                const Parameterization& parameterization,
                                                const Eigen::MatrixXd& inverse,
                                                const Eigen::Vector3d& known);

}  // namespace calvin
