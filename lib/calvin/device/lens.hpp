// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The lens of a camera that the system drives: where its focus and zoom stand, and who moves them.
#pragma once

#include <optional>
#include <string>

#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// A field is absent where the camera has no such control: most have none for the zoom, and those
// with a fixed lens have none at all.
struct LensState {
  CaptureDevice device;      // its `autofocus` is focus_automatic_continuous
  std::optional<int> focus;  // focus_absolute, and zoom_absolute: in units of the camera's own
  std::optional<int> zoom;
};

// Opens the V4L2 node, reads and closes it again, beside whoever streams from it. Takes as long as
// the driver does, which asks the camera itself. The error says what to do; kUnsupported in a build
// without V4L2.
[[nodiscard]] Result<LensState> read_lens(const std::string& node);

}  // namespace calvin
