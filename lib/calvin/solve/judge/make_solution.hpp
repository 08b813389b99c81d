// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// From the last least squares to the Solution that the user gets. Internal.
#pragma once

#include <stop_token>
#include <string_view>
#include <vector>

#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/solution.hpp"

namespace calvin {

struct FinishedFit {
  const Fit& fit;
  const Parameterization& parameterization;
  const BoardShape& shape;
  WeightScale scale;
  double chi = 1;  // against the detector's sigmas alone
};

// Whether the views in use have equations enough for the unknowns: before a fit, and after it.
[[nodiscard]] Status check_equations(const std::vector<PointSet>& views,
                                     const std::vector<bool>& used,
                                     const Parameterization& parameterization,
                                     std::string_view model);

// The solution of a fit, or kDegenerate with the reason why it determines no camera.
// Calibration::camera and board are left empty.
[[nodiscard]] Result<Solution> make_solution(const FinishedFit& from, ImageSize size,
                                             const SolveOptions& options,
                                             const std::stop_token& stop);

}  // namespace calvin
