// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sticky downstream event `calvin-calibration` {camera, json, undistorted}.
#pragma once

#include <optional>
#include <string>

#include <gst/gst.h>

namespace calvin::gst {

inline constexpr char kCalibrationEvent[] = "calvin-calibration";

struct CalibrationEvent {
  std::string camera;
  std::string json;  // native calibration; empty: the frames have none any more
  // An element upstream has taken the distortion out; the field is there where it has.
  bool undistorted = false;
};

[[nodiscard]] GstEvent* new_calibration_event(const CalibrationEvent& calibration);

// Absent where the event is another one.
[[nodiscard]] std::optional<CalibrationEvent> parse_calibration_event(GstEvent* event);

}  // namespace calvin::gst
