// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is said of boards that are fixed to each other. Internal.
#pragma once

#include <string>
#include <vector>

#include "calvin/core/rig.hpp"
#include "calvin/rig/fixed/solve_with_boards.hpp"

namespace calvin::rig {

// Adds where boards are to each other, with lengths `scale` times those of the solve, and sentences
// for boards that no picture joins to another one.
void set_fixed_boards(const std::vector<RigCameraViews>& seen, const BoardsSolve& one, double scale,
                      Rig& to, std::vector<std::string>& remarks);

}  // namespace calvin::rig
