// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibsolve says on the bus.
#pragma once

#include <string>

#include <gst/gst.h>

#include "calvin/core/reason.hpp"
#include "calvin/session/earlier_calibration.hpp"
#include "calvin/session/progress.hpp"
#include "calvin/solve/solve.hpp"
#include "common/messages.hpp"

namespace calvin::gst {

[[nodiscard]] GstStructure* view_message(const FrameTimes& times, const std::string& camera,
                                         Reason reason, const Progress& progress);
[[nodiscard]] GstStructure* progress_message(const FrameTimes& times, const std::string& camera,
                                             const Progress& progress);
// `json` is the native text of the calibration for the final result, else nullptr.
[[nodiscard]] GstStructure* result_message(const FrameTimes& times, const Solution& solution,
                                           const std::string& location, const char* json);

// What the first views say of the calibration that was there before.
[[nodiscard]] GstStructure* check_message(const SolveJob& job, const EarlierVerdict& verdict);

// For a WARNING: what the meta calvin-observation holds cannot be an observation, and why.
[[nodiscard]] Error broken_observation(const Error& why);

}  // namespace calvin::gst
