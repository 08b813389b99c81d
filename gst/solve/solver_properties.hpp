// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibsolve.
#pragma once

#include "common/properties.hpp"
#include "solve/calib_solver.hpp"

namespace calvin::gst {

extern const Properties<CalibSolver> kSolverProperties;

}  // namespace calvin::gst
