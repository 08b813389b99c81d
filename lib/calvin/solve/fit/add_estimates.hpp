// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Copies what was estimated into a Solution. Internal.
#pragma once

#include <Eigen/Core>

#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/target/measured/board_measurement.hpp"

namespace calvin {

// The sigmas of the parameters, which are in place, and their covariance; the modes of the board;
// the readout. `covariance` is over all unknowns of the table.
void add_estimates(Solution& solution, const Fit& fit, const ParameterTable& table,
                   const Eigen::MatrixXd& covariance);

// The board of a fit that has one, estimated or known. `variance` is that of a residual of weight
// 1, px^2.
void add_board(Solution& solution, const Fit& fit, const BoardMeasurement& prior, double variance);

}  // namespace calvin
