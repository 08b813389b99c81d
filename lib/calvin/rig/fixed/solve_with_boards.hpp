// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Joint solves of a rig before boards that are fixed to each other. Internal.
#pragma once

#include <stop_token>
#include <vector>

#include "calvin/rig/clocks/solve_with_clocks.hpp"
#include "calvin/rig/fixed/fixed_boards.hpp"

namespace calvin::rig {

struct BoardsSolve {
  JointSolve joint;
  std::vector<BoardOnBody> boards;  // by BoardView::own_board
};

// Of a problem with InstantsOf::kTwoViews or kAny. How boards lie to each other is found from
// pictures that show several of them, then with all places in one least squares; of boards whose
// relation no picture shows each is carried by itself. kInvalidArgument for two boards that are
// alike in one picture; kDegenerate where cameras cannot be placed because no picture shows two
// boards, and where the views leave open how boards are fixed; else errors are those of
// solve_with_clocks().
[[nodiscard]] Result<BoardsSolve> solve_with_boards(const JointProblem& problem,
                                                    const std::stop_token& stop);

}  // namespace calvin::rig
