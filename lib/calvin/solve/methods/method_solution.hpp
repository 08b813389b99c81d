// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a method finds by itself, as a Solution. Internal.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/solution.hpp"

namespace calvin {

// SolveOptions::method without the least squares after it: the camera in the method's own model,
// the poses and the residuals of all corners; no promise and no verdict, which are of the least
// squares, and sigmas only where the method has some itself. Camera and board text of
// Solution::calibration are left empty.
[[nodiscard]] Result<Solution> method_solution(std::vector<PointSet> views, ImageSize size,
                                               const SolveOptions& options);

}  // namespace calvin
