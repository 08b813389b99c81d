// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What events from downstream ask of calibrig: its action signals as custom events, and clicks in
// the picture of a camera.
#pragma once

#include <optional>
#include <string>

#include <gst/gst.h>

#include "calvin/session/points/manual_points.hpp"
#include "rig/rig_solver.hpp"

namespace calvin::gst {

struct RigCommand {
  enum class Kind { kReinsert, kPoint, kRemovePoint, kClick, kTakeOut };
  Kind kind = Kind::kReinsert;
  std::string camera = {};  // its name; empty: that of the pad which the event comes to
  std::optional<unsigned> index = std::nullopt;  // of the point to remove; absent: the newest one
  PointChoice point = {};
  bool is_ours = false;  // the event was made for it, and nobody upstream wants it
};

// calvin-reinsert {camera}, calvin-point {uv, world, sigma, camera}, calvin-remove-point {index,
// camera}, and buttons of a mouse. Absent for other events.
[[nodiscard]] std::optional<RigCommand> rig_command(GstEvent* event);

// `sink`: the pad of the camera that the event is of. A click chooses a point where the pad has
// points to choose, and nothing else.
void run_command(RigSolver& solver, const RigCommand& command, GstPad* sink);

}  // namespace calvin::gst
