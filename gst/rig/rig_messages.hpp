// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibrig says on the bus and downstream.
#pragma once

#include <string>

#include <gst/gst.h>

#include "calvin/session/rig/rig_session.hpp"
#include "common/messages.hpp"

namespace calvin::gst {

// calib-rig-progress {cameras, links: array of {a, b, views}, weakest}.
[[nodiscard]] GstStructure* rig_progress_message(const FrameTimes& times,
                                                 const RigProgress& progress);

// calib-rig-result {state, cameras, rms, location, links: array of {a, b, views, agree, distance,
// distance-sigma, angle, bias, spread, epipolar-error}, weakest, missing: array of {camera,
// reason}, pairing, time-offsets: array of {camera, offset, sigma}, remarks, json in the final
// one}.
[[nodiscard]] GstStructure* rig_result_message(const FrameTimes& times, const RigSolution& solution,
                                               const std::string& location, const char* json);

// calib-rig-moved {cameras, since, distance, angle}.
[[nodiscard]] GstStructure* rig_moved_message(const FrameTimes& times, const MovedCamera& moved);

}  // namespace calvin::gst
