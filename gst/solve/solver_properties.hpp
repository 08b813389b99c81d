// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibsolve.
#pragma once

#include "common/field.hpp"
#include "solve/solver_settings.hpp"

namespace calvin::gst {

// Properties 1..kSolverSettings are kept in the settings, the two behind them are not.
inline constexpr guint kSolverSettings = 13;
enum SolverProperty : guint { kSolverCalibration = kSolverSettings + 1, kSolverStats };

void install_solver_properties(GObjectClass* object_class);

// Where the property of that number is kept; nowhere for those two.
[[nodiscard]] Field solver_field(SolverSettings& settings, guint id);

}  // namespace calvin::gst
