// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A solve as other people's solvers do it, to be compared with them.
#pragma once

#include <string>
#include <string_view>

#include "calvin/solve/solve.hpp"

namespace calvin::scenes {

// Least squares over all corners, and its covariance: no search for outliers, no checks, a flat
// board.
inline SolveOptions plain_options(std::string_view model) {
  SolveOptions options;
  options.model = model;
  options.reject_outliers = false;
  options.checks = false;
  // A version that estimates the shape of the board is told not to.
  [](auto& o) {
    if constexpr (requires { o.warp = false; }) o.warp = false;
  }(options);
  return options;
}

}  // namespace calvin::scenes
