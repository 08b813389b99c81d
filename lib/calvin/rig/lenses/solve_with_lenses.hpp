// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Places and intrinsics of a rig in one least squares. Internal.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/rig/fixed/solve_with_boards.hpp"

namespace calvin::rig {

struct LensSolve {
  BoardsSolve boards;  // its covariance of the places holds what is not known of the intrinsics
  std::vector<Camera> cameras;
  std::vector<Calibration> calibrations;  // the given ones where intrinsics were held
  std::vector<std::string> remarks;       // which were held and why, and what contradicts a prior
};

// A solve of the places for every step of Gauss-Newton that intrinsics make. With `has_prior` what
// was known of the intrinsics counts, and those of which it is not known how well they are known
// are held; else the views alone count, and cameras whose intrinsics they leave open are held.
// Errors are those of solve_with_boards(), or, where boards are not `are_fixed`, of
// solve_with_clocks(); kDegenerate where the steps come to no end. How the clocks are off and
// boards are fixed adds to the covariance as if intrinsics were held.
[[nodiscard]] Result<LensSolve> solve_with_lenses(const JointProblem& problem, bool has_prior,
                                                  bool are_fixed, const std::stop_token& stop);

// The places alone.
[[nodiscard]] Result<BoardsSolve> solve_places(JointProblem problem, bool are_fixed,
                                               const std::stop_token& stop);

}  // namespace calvin::rig
