// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Installs the properties of calibtestsrc and names the setting behind each.

#include "testsrc/test_properties.hpp"

namespace calvin::gst {

namespace {

enum Property : guint {
  kBoard = 1,
  kCalibration,
  kMotion,
  kNoise,
  kBlur,
  kExposure,
  kSeed,
  kGroundTruth,
  kReadoutTime,
};
static_assert(kReadoutTime == kTestSettings);

GType motion_type() {
  static const GEnumValue kValues[] = {
      {static_cast<int>(MotionKind::kRandom),
       "Independent poses all over the image: one per frame, when live one per 0.5 s", "random"},
      {static_cast<int>(MotionKind::kOrbit), "The camera circles the board in 10 s", "orbit"},
      {static_cast<int>(MotionKind::kHand), "A smooth path as of a board held by hand", "hand"},
      {static_cast<int>(MotionKind::kStatic), "One pose", "static"},
      {0, nullptr, nullptr}};
  static const GType kType = g_enum_register_static("GstCalibTestSrcMotion", kValues);
  return kType;
}

void install_scene_properties(GObjectClass* object_class) {
  g_object_class_install_property(
      object_class, kBoard,
      g_param_spec_string(
          "board", "Board",
          "The board to render, KIND:COLSxROWS:SIZE with inner corners and the side "
          "of a square, or FILE.json#NAME",
          kDefaultBoard.data(), kMutableReady));
  g_object_class_install_property(
      object_class, kCalibration,
      g_param_spec_string("calibration", "Calibration",
                          "The camera to be: a calibration file, its content, or a list "
                          "fx=..,fy=..,cx=..,cy=..,k1=..,width=..,height=..; unset: a brown5 "
                          "camera 70 degrees wide, for any size",
                          nullptr, kMutableReady));
  g_object_class_install_property(
      object_class, kMotion,
      g_param_spec_enum("motion", "Motion", "How the board moves before the camera", motion_type(),
                        static_cast<int>(MotionKind::kRandom), kMutableReady));
  g_object_class_install_property(
      object_class, kSeed,
      g_param_spec_uint64("seed", "Seed", "Choice of the poses and the noise, never of the camera",
                          0, G_MAXUINT64, 0, kMutableReady));
  g_object_class_install_property(
      object_class, kTestIsLive,
      g_param_spec_boolean("is-live", "Is Live", "Deliver frames in real time, as a camera does",
                           FALSE, kMutableReady));
  g_object_class_install_property(
      object_class, kGroundTruth,
      g_param_spec_string("ground-truth", "Ground Truth",
                          "File to write the camera to, as a calibration; unset: none", nullptr,
                          kMutableReady));
}

void install_image_properties(GObjectClass* object_class) {
  g_object_class_install_property(
      object_class, kNoise,
      g_param_spec_double("noise", "Noise", "Noise of the sensor in grey levels of 255, 1 sigma", 0,
                          100, kDefaultNoise, kMutablePlaying));
  g_object_class_install_property(
      object_class, kBlur,
      g_param_spec_double("blur", "Blur", "Gaussian blur of the optics in px, 1 sigma", 0, 50,
                          kDefaultBlur, kMutablePlaying));
  g_object_class_install_property(
      object_class, kExposure,
      g_param_spec_double("exposure", "Exposure",
                          "Factor on all grey levels; those above 255 are cut off", 0, 100, 1,
                          kMutablePlaying));
  g_object_class_install_property(
      object_class, kReadoutTime,
      g_param_spec_uint64("readout-time", "Readout Time",
                          "Time in ns from the first row of a frame to the last, as of a rolling "
                          "shutter, in which an orbit or a hand goes on moving (0 = all at once)",
                          0, GST_SECOND, 0, kMutablePlaying));
}

}  // namespace

void install_test_properties(GObjectClass* object_class) {
  install_scene_properties(object_class);
  install_image_properties(object_class);
  gst_type_mark_as_plugin_api(motion_type(), static_cast<GstPluginAPIFlags>(0));
}

Field test_field(TestSettings& settings, guint id) {
  switch (id) {
    case kBoard:
      return settings.scene.board;
    case kCalibration:
      return settings.scene.calibration;
    case kMotion:
      return settings.scene.motion;
    case kNoise:
      return settings.render.noise;
    case kBlur:
      return settings.render.blur;
    case kExposure:
      return settings.render.exposure;
    case kSeed:
      return settings.scene.seed;
    case kGroundTruth:
      return settings.ground_truth;
    case kReadoutTime:
      return settings.readout_time;
    default:
      return {};
  }
}

}  // namespace calvin::gst
