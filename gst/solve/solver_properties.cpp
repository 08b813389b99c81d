// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Installs the properties of calibsolve and names the setting behind each.

#include "solve/solver_properties.hpp"

#include <string>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"

namespace calvin::gst {

namespace {

enum Property : guint {
  kLocation = 1,
  kExport,
  kCamera,
  kModel,
  kFix,
  kInitial,
  kWarp,
  kSkew,
  kCaptureMode,
  kMinViews,
  kMaxViews,
  kTargetError,
  kRuns,
};
static_assert(kRuns == kSolverSettings);

GType capture_mode_type() {
  static const GEnumValue kValues[] = {
      {kCaptureDefault, "All when the source is not live, auto when it is", "default"},
      {kCaptureAll, "Every view with a board; only outliers are dropped", "all"},
      {kCaptureAuto, "Views that are still, large and unlike those before", "auto"},
      {kCaptureManual, "Only on the signal capture-view", "manual"},
      {0, nullptr, nullptr}};
  static const GType kType = g_enum_register_static("GstCalibSolveCaptureMode", kValues);
  return kType;
}

// Blurbs that list what the library has. They are never freed: GObject keeps the pointers.
const char* model_blurb() {
  static const auto& kBlurb = *new std::string(
      fmt::format("Camera model: {}, or auto for the simplest one that tells all views",
                  join(model_names(), ", ")));
  return kBlurb.c_str();
}

const char* export_blurb() {
  static const auto& kBlurb = *new std::string(
      fmt::format("Further files in other formats, FORMAT:PATH,FORMAT:PATH with the formats {}",
                  join(calibration_formats(), ", ")));
  return kBlurb.c_str();
}

}  // namespace

Field solver_field(SolverSettings& settings, guint id) {
  switch (id) {
    case kLocation:
      return settings.location;
    case kExport:
      return settings.exports;
    case kCamera:
      return settings.camera;
    case kModel:
      return settings.model;
    case kFix:
      return settings.fix;
    case kInitial:
      return settings.initial;
    case kWarp:
      return settings.warp;
    case kSkew:
      return settings.skew;
    case kCaptureMode:
      return settings.capture_mode;
    case kMinViews:
      return settings.min_views;
    case kMaxViews:
      return settings.max_views;
    case kTargetError:
      return settings.target_error;
    case kRuns:
      return settings.runs;
    default:
      return {};
  }
}

void install_solver_properties(GObjectClass* object_class) {
  const auto text = [object_class](guint id, const char* name, const char* nick, const char* blurb,
                                   const char* value, GParamFlags flags) {
    g_object_class_install_property(object_class, id,
                                    g_param_spec_string(name, nick, blurb, value, flags));
  };
  text(kLocation, "location", "Location",
       "File for the calibration (native JSON), written at the first solve and whenever it got "
       "better; that of another session is replaced by the final result, or by one as good",
       nullptr, kMutablePlaying);
  text(kExport, "export", "Export", export_blurb(), nullptr, kMutablePlaying);
  text(kCamera, "camera", "Camera",
       "Name of the camera in messages and files (unset = the one that the observations carry)",
       nullptr, kMutablePlaying);
  text(kModel, "model", "Model", model_blurb(), "brown5", kMutablePlaying);
  text(kFix, "fix", "Fix",
       "What not to estimate, separated by commas: a parameter, held at its value in initial, or "
       "else a distortion coefficient at 0 and cx, cy (center for both) at the middle of the "
       "picture. What to tie: aspect (fy:fx as in initial, or else 1), fx=fy, k1=k2",
       nullptr, kMutablePlaying);
  text(kInitial, "initial", "Initial",
       "A calibration (a file, or whatever calibundistort takes) to start the solve from, which "
       "also gives the values that fix holds; unset: the views alone tell",
       nullptr, kMutablePlaying);
  const auto choice = [object_class](guint id, const char* name, const char* nick,
                                     const char* blurb, bool value) {
    g_object_class_install_property(
        object_class, id, g_param_spec_boolean(name, nick, blurb, value, kMutablePlaying));
  };
  choice(kWarp, "warp", "Warp",
         "Estimate the two curvatures of the board too, from 8 views of one board on", true);
  choice(kSkew, "skew", "Skew", "Estimate the skew of the pixel axes too", false);
  g_object_class_install_property(
      object_class, kCaptureMode,
      g_param_spec_enum("capture-mode", "Capture Mode", "Which views of the board are kept",
                        capture_mode_type(), kCaptureDefault, kMutablePlaying));
  g_object_class_install_property(
      object_class, kMinViews,
      g_param_spec_int("min-views", "Minimum Views", "Views that a calibration needs at least", 2,
                       1000, 3, kMutablePlaying));
  g_object_class_install_property(
      object_class, kMaxViews,
      g_param_spec_int("max-views", "Maximum Views",
                       "Views after which nothing more is captured and the final result is posted "
                       "(0 = no limit)",
                       0, 100000, 0, kMutablePlaying));
  g_object_class_install_property(
      object_class, kTargetError,
      g_param_spec_double("target-error", "Target Error",
                          "Expected error in px (1 sigma, anywhere in the picture) at which "
                          "nothing more is captured and the final result is posted (0 = never)",
                          0, 100, 0, kMutablePlaying));
  g_object_class_install_property(
      object_class, kRuns,
      g_param_spec_int(
          "runs", "Runs",
          "Solves that make a final result: before each after the first one the "
          "corners of views taken since it is set are looked at again, as lens and pose "
          "let them be seen",
          1, 20, 1, kMutablePlaying));
  text(kSolverCalibration, "calibration", "Calibration",
       "The newest calibration as native JSON (unset before the first solve)", nullptr, kReadOnly);
  g_object_class_install_property(
      object_class, kSolverStats,
      g_param_spec_boxed("stats", "Statistics",
                         "State of the session: views, coverage 0..1, rms px, expected-error px",
                         GST_TYPE_STRUCTURE, kReadOnly));
  gst_type_mark_as_plugin_api(capture_mode_type(), static_cast<GstPluginAPIFlags>(0));
}

}  // namespace calvin::gst
