// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views of a board -> Calibration, by least squares on the reprojection error.
//
// Start: Zhang's closed form (A Flexible New Technique for Camera Calibration, PAMI 22(11), 2000)
// with tests of its signs, or several focal lengths tried where that form does not apply. Then
// Levenberg-Marquardt over the camera and all board poses at once, each pose eliminated by its
// 6x6 block. Gross corners and wholly wrong views are found by a robust solve, left out and named.
#pragma once

#include <span>
#include <stop_token>

#include "calvin/core/export.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/misfit.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

// Whether solve() knows the model and what is to be fixed, can start from `initial`, and the
// numbers are ones that a solve may have. What solve() checks first.
[[nodiscard]] CALVIN_API Status check(const SolveOptions& options);

// kInvalidArgument: a broken view, option or image size. kUnsupported: unknown model.
// kDegenerate: too little or too uniform data to determine the camera. kCancelled: `stop` was
// requested, which is looked at in every iteration. The result is finite whenever there is one.
// Thread-safe; keeps nothing.
[[nodiscard]] CALVIN_API Result<Solution> solve(std::span<const View> views, ImageSize image_size,
                                                const SolveOptions& options = {},
                                                std::stop_token stop = {});

}  // namespace calvin
