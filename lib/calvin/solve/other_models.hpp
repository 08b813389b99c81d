// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a solve finds fault with, and one with another lens or board does not. Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "calvin/solve/judge/solve_points.hpp"

namespace calvin {

// Whether what a solve has found may be of a lens that its model does not have: that, too, makes
// views, or halves of them, contradict each other.
[[nodiscard]] bool may_be_the_lens(const Misfit& misfit);

// Where a solve has found what its model may be to blame for: what predicts views held out with
// clearly less of the variance is looked for, first the same model with nothing held, then with a
// board whose aspect is another by 5 sigma (`stretched`, absent where views do not tell), then the
// models that auto tries, where it has not. The promises hold how far the two are apart, and the
// first remark names it. It is the cause of a misfit where that error is above a pixel, and where
// it was suspected and leaves half of the variance.
void try_others(Solution& solution, const std::vector<PointSet>& views, const BoardShape& shape,
                const std::optional<BoardShape>& stretched, ImageSize image_size,
                const SolveOptions& options, const std::stop_token& stop);

}  // namespace calvin
