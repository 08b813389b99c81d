// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// solve() from points on. Internal.
#pragma once

#include <stop_token>
#include <vector>

#include "calvin/solve/options.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/residuals/view_points.hpp"
#include "calvin/solve/solution.hpp"

namespace calvin {

// Solves for one model. `shape` has the modes of the board that are estimated. Camera and board
// text of Solution::calibration are left empty.
[[nodiscard]] Result<Solution> solve_points(std::vector<PointSet> views, const BoardShape& shape,
                                            ImageSize image_size, const SolveOptions& options,
                                            const std::stop_token& stop = {});

}  // namespace calvin
