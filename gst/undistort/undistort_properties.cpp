// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Installs the properties of calibundistort and names the setting behind each.

#include "undistort/undistort_properties.hpp"

namespace calvin::gst {

namespace {

enum Property : guint {
  kCalibration = 1,
  kSettings,
  kEnabled,
  kUndistort,
  kOutputCalibration,
  kFirstOfView
};
static_assert(kOutputCalibration == kUndistortOutputCalibration);

}  // namespace

Field undistort_field(UndistortSettings& settings, guint id) {
  switch (id) {
    case kCalibration:
    case kSettings:
      return settings.calibration;
    case kEnabled:
    case kUndistort:
      return settings.enabled;
    case kOutputCalibration:
      return {};
    default:
      return view_field(settings.view, id - kFirstOfView);
  }
}

const char* other_name(guint id) {
  switch (id) {
    case kCalibration:
      return "settings";
    case kSettings:
      return "calibration";
    case kEnabled:
      return "undistort";
    case kUndistort:
      return "enabled";
    default:
      return nullptr;
  }
}

bool tells_calibration(guint id) { return id == kCalibration || id == kSettings; }

void install_undistort_properties(GObjectClass* object_class) {
  const auto install = [&](guint id, GParamSpec* spec) {
    g_object_class_install_property(object_class, id, spec);
  };
  install(
      kCalibration,
      g_param_spec_string(
          "calibration", "Calibration",
          "The calibration: a file (native JSON, OpenCV, ROS), which may appear later and is read "
          "again when it is replaced; or JSON text; or the settings of cameraundistort; or a list "
          "such as fx=500,fy=500,cx=319.5,cy=239.5,k1=-0.2,width=640,height=480. Empty: the "
          "calibration event of an element upstream",
          nullptr, kMutablePlaying));
  install(kSettings,
          g_param_spec_string("settings", "Settings",
                              "The same as calibration, by the name that cameraundistort has for "
                              "it: its pipelines work with this element in its place",
                              nullptr, kMutablePlaying));
  install(kEnabled, g_param_spec_boolean("enabled", "Enabled",
                                         "Undistort; off: the frames pass through untouched, "
                                         "or scaled where the output has another size",
                                         TRUE, kMutablePlaying));
  install(kUndistort,
          g_param_spec_boolean("undistort", "Undistort",
                               "The same as enabled, by the name that cameraundistort has for it",
                               TRUE, kMutablePlaying));
  install(kOutputCalibration,
          g_param_spec_string("output-calibration", "Output Calibration",
                              "The calibration of the output as native JSON: a pinhole camera (or "
                              "an ideal fisheye, where that is the projection) while it is "
                              "undistorted, what came from upstream while it passes through or is "
                              "scaled; empty where no model describes the projection",
                              nullptr, kReadOnly));
  install_view_properties(object_class, kFirstOfView);
}

}  // namespace calvin::gst
