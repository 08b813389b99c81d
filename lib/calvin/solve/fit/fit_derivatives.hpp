// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The derivatives of a fit's residuals by the places of corners on their boards. Internal.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "calvin/solve/fit/camera_fit.hpp"

namespace calvin {

// The residuals of one view, all of u and then all of v, and their derivatives.
struct ViewDerivatives {
  std::size_t view = 0;  // its number in the fit
  std::vector<int> ids;  // of the corners, whose rows come first in either half
  Eigen::VectorXd residual;
  Eigen::MatrixXd pose;     // by the pose
  Eigen::MatrixXd to_pose;  // from residuals to the pose that explains most of them
  Eigen::MatrixXd shared;   // by the shared unknowns, the pose eliminated
  Eigen::Matrix<double, Eigen::Dynamic, 3> along;  // by the place of its corner, in board axes

  [[nodiscard]] Eigen::Index height() const { return residual.size() / 2; }
};

// Calls `use` with the derivatives of each view used, at the optimum.
void for_view_derivatives(const Fit& fit, const BoardShape& shape,
                          const Parameterization& parameterization,
                          const std::function<void(ViewDerivatives)>& use);

}  // namespace calvin
