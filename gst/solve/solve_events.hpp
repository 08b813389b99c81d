// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What events from downstream ask of calibsolve: the action signals as custom events, and the keys
// and clicks of whoever looks at the picture.
#pragma once

#include <optional>

#include <gst/gst.h>

namespace calvin::gst {

struct SolveCommand {
  enum class Kind { kCaptureView, kSolve, kReset, kRemoveView };
  Kind kind = Kind::kCaptureView;
  std::optional<unsigned> index;  // of the view to remove; absent: the newest one
  bool is_ours = false;           // the event was made for it, and nobody upstream wants it
};

// Absent for an event that asks for nothing.
[[nodiscard]] std::optional<SolveCommand> solve_command(GstEvent* event);

}  // namespace calvin::gst
