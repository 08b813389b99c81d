// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What events from downstream ask of calibsolve: the action signals as custom events, and the keys
// and clicks of whoever looks at the picture.
#pragma once

#include <optional>

#include <gst/gst.h>

#include "calvin/core/image.hpp"
#include "calvin/session/points/manual_points.hpp"

namespace calvin::gst {

struct SolveCommand {
  enum class Kind {
    kCaptureView,
    kSolve,
    kReset,
    kRemoveView,
    kPoint,
    kRemovePoint,
    kClick,    // a point, where points are to be chosen, or else a view
    kUndo,     // the newest point, or else the newest view
    kTakeOut,  // the newest point, if any
  };
  Kind kind = Kind::kCaptureView;
  std::optional<unsigned> index = std::nullopt;  // of what to remove; absent: the newest one
  bool is_ours = false;    // the event was made for it, and nobody upstream wants it
  PointChoice point = {};  // of kPoint, and where a click was
};

// Absent for an event that asks for nothing.
[[nodiscard]] std::optional<SolveCommand> solve_command(GstEvent* event);

}  // namespace calvin::gst
