// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is solved where the views do not determine the model that was asked for. Internal.
#pragma once

#include <stop_token>
#include <string_view>
#include <vector>

#include "calvin/solve/judge/solve_points.hpp"

namespace calvin {

// The models whose coefficients are some of those of `model`, the richest first: of rational8
// brown5, brown4 and pinhole; of doublesphere ucm. A picture of theirs is one of `model`.
[[nodiscard]] std::vector<std::string_view> simpler_models(std::string_view model);

// Whether a solution leaves its model open: kDegenerate, or little promised.
[[nodiscard]] bool leaves_open(const Result<Solution>& asked, ImageSize image_size);

// Instead of one that leaves its model open, the solution for the richest simpler model that the
// views determine and that is no misfit; its first remark says so. A solution gives way only to one
// that predicts the views held out as well and promises much more. `asked` where there is none.
[[nodiscard]] Result<Solution> solve_simpler(Result<Solution> asked,
                                             const std::vector<PointSet>& views,
                                             const BoardShape& shape, ImageSize image_size,
                                             const SolveOptions& options,
                                             const std::stop_token& stop = {});

}  // namespace calvin
