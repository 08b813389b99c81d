// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What corners that are not where they were printed do to a camera. Internal.
#pragma once

#include <Eigen/Core>

#include "calvin/solve/fit/camera_fit.hpp"

namespace calvin {

// The covariance of the directions where every corner of a board is off in its plane by 1 m (1
// sigma) along each axis, by itself, and in all views alike.
[[nodiscard]] Eigen::MatrixXd board_covariance(const Fit& fit, const BoardShape& shape,
                                               const Parameterization& parameterization);

}  // namespace calvin
