// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// solve() from points on. Internal.
#pragma once

#include <stop_token>
#include <vector>

#include "calvin/solve/options.hpp"
#include "calvin/solve/points.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/view_points.hpp"

namespace calvin {

// Solution::calibration lacks camera and board text. `shape` is what of the board may be estimated.
[[nodiscard]] Result<Solution> solve_points(std::vector<PointSet> views, const BoardShape& shape,
                                            ImageSize image_size, const SolveOptions& options,
                                            const std::stop_token& stop = {});

}  // namespace calvin
