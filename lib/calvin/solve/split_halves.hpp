// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far calibrations of two halves of the views are apart. Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "calvin/solve/judge/solve_points.hpp"

namespace calvin {

// At most 50 of the views, as evenly as they come: a part of many tells models apart as well.
[[nodiscard]] std::vector<PointSet> some_of(const std::vector<PointSet>& views);

// px: the largest difference of a projection where the corners of both halves covered the picture,
// a rotation of the camera removed; the geometric mean over ways to halve the views, which are the
// same in each call. `all`: the calibration of all of them, of the model in `options`. Absent where
// there are too few views or halves do not determine the model.
[[nodiscard]] std::optional<double> split_half_difference(const std::vector<PointSet>& views,
                                                          const Calibration& all,
                                                          const BoardShape& shape,
                                                          const SolveOptions& options,
                                                          const std::stop_token& stop);

}  // namespace calvin
