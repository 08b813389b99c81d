// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a solve finds fault with, and another model does not. Internal.
#pragma once

#include <stop_token>
#include <vector>

#include "calvin/solve/judge/solve_points.hpp"

namespace calvin {

// Whether what a solve has found may be of a lens that its model does not have: that, too, makes
// views, or halves of them, contradict each other.
[[nodiscard]] bool may_be_the_lens(const Misfit& misfit);

// Where a solve has found what its model may be to blame for: where the same model with nothing
// held, or else a model that auto tries, predicts views held out with clearly less of the variance,
// the promises hold how far the two are apart, and the first remark names it. The model is the
// cause of a misfit where that error is above a pixel, and where a lens was suspected that leaves
// half of the variance.
void try_other_models(Solution& solution, const std::vector<PointSet>& views,
                      const BoardShape& shape, ImageSize image_size, const SolveOptions& options,
                      const std::stop_token& stop);

// The same with the same model and a board that is `stretched`, a shape with its aspect: where that
// is better, and the aspect is another by 5 sigma, the board is the cause. False where it is not.
bool try_stretched(Solution& solution, const std::vector<PointSet>& views,
                   const BoardShape& stretched, ImageSize image_size, const SolveOptions& options,
                   const std::stop_token& stop);

}  // namespace calvin
