// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// model=auto: which camera model the views ask for. Internal.
#pragma once

#include <stop_token>
#include <string_view>
#include <vector>

#include "calvin/solve/judge/solve_points.hpp"

namespace calvin {

inline constexpr std::string_view kAutoModel = "auto";

// Solves for every sensible model. Of those that predict views held out to within 3 % of the best,
// the simplest on which halves of the views agree to within 10 % of the best; or one on which they
// agree to within 20 %, where it knows much more of what no corner was seen in.
// Calibration::remarks says which model was taken and why.
[[nodiscard]] Result<Solution> solve_auto(const std::vector<PointSet>& views,
                                          const BoardShape& shape, ImageSize image_size,
                                          const SolveOptions& options, const std::stop_token& stop);

}  // namespace calvin
