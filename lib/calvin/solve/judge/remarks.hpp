// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user is told beside the numbers. Internal.
#pragma once

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/solution.hpp"

namespace calvin {

// Adds remarks on parameters that are weak but not refused, on what makes the result worse than
// noise would, on what no corner covered, and on the lens. `c` is the covariance of all unknowns.
void add_remarks(Solution& solution, const Eigen::MatrixXd& c, const Camera& camera,
                 const Parameterization& parameterization);

}  // namespace calvin
