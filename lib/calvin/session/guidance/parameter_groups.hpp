// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What of a camera is known by now, in words of its user.
#pragma once

#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/session/progress.hpp"

namespace calvin {

// What the uncertainty of some parameters does to projections.
struct GroupError {
  std::string name;           // as of ParameterGroup
  double expected_error = 0;  // px, 1 sigma: the largest anywhere in the picture
};

// Of the groups that the calibration's model has, in the order focal length, principal point,
// distortion: expected_error_anywhere() of their part of the covariance alone, or that of the whole
// where it is less, since errors of parameters that are correlated may cancel. 0 for parameters
// that were given and not estimated. Takes a millisecond.
[[nodiscard]] std::vector<GroupError> parameter_errors(const Calibration& calibration);

// How well they are known; `wanted` px, 1 sigma.
[[nodiscard]] std::vector<ParameterGroup> parameter_groups(const std::vector<GroupError>& errors,
                                                           double wanted);

// "fx 536.1 ± 0.4" for each parameter, to the leading digit of its sigma; without one where there
// is none.
[[nodiscard]] std::vector<std::string> parameter_lines(const Calibration& calibration);

}  // namespace calvin
