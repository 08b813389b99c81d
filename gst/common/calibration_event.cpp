// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sticky downstream event `calvin-calibration`.

#include "common/calibration_event.hpp"

#include "common/values.hpp"

namespace calvin::gst {

GstEvent* new_calibration_event(const CalibrationEvent& calibration) {
  GstStructure* s = gst_structure_new(kCalibrationEvent, "camera", G_TYPE_STRING,
                                      displayed(calibration.camera).c_str(), "json", G_TYPE_STRING,
                                      displayed(calibration.json).c_str(), nullptr);
  if (calibration.undistorted) {
    gst_structure_set(s, "undistorted", G_TYPE_BOOLEAN, TRUE, nullptr);
  }
  return gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_STICKY, s);
}

std::optional<CalibrationEvent> parse_calibration_event(GstEvent* event) {
  if (GST_EVENT_TYPE(event) != GST_EVENT_CUSTOM_DOWNSTREAM_STICKY ||
      !gst_event_has_name(event, kCalibrationEvent)) {
    return std::nullopt;
  }
  const GstStructure* s = gst_event_get_structure(event);
  gboolean undistorted = FALSE;
  gst_structure_get_boolean(s, "undistorted", &undistorted);
  return CalibrationEvent{get_string(s, "camera"), get_string(s, "json"), undistorted != FALSE};
}

}  // namespace calvin::gst
