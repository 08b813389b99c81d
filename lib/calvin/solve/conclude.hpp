// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// From the last least squares to what the user is told. Internal.
#pragma once

#include <stop_token>
#include <string_view>
#include <vector>

#include "calvin/solve/fit.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/weights.hpp"

namespace calvin {

struct Conclusion {
  const Fit& fit;
  const Freedom& freedom;
  const BoardShape& shape;
  WeightScale scale;
  double chi = 1;  // against the detector's sigmas alone
};

// Whether there is enough to begin with, or left to end with.
[[nodiscard]] Status enough(const std::vector<PointSet>& views, const std::vector<bool>& used,
                            const Freedom& freedom, std::string_view model);

// Whether the result means anything, and what it is worth. Calibration::camera and board are left
// empty.
[[nodiscard]] Result<Solution> conclude(const Conclusion& from, ImageSize size,
                                        const SolveOptions& options, const std::stop_token& stop);

}  // namespace calvin
