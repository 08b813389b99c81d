// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Installs the properties of the view, and gives them to the library in its units.

#include "undistort/view_properties.hpp"

#include <numbers>

#include "common/properties.hpp"

namespace calvin::gst {

namespace {

enum Which : guint {
  kAlpha,
  kAlphaMode,
  kProjection,
  kZoom,
  kPan,
  kTilt,
  kRoll,
  kDirection,
  kInterpolation,
  kFill,
  kThreads
};

constexpr double kRadians = std::numbers::pi / 180;

constexpr auto kAnimated = static_cast<GParamFlags>(kMutablePlaying | GST_PARAM_CONTROLLABLE);

template <typename E>
constexpr int number(E value) {
  return static_cast<int>(value);
}

const GEnumValue kAlphaModes[] = {
    {number(AlphaMode::kCalvin), "The largest view; pixels keep their aspect", "calvin"},
    {number(AlphaMode::kOpenCv), "What cameraundistort shows", "opencv"},
    {0, nullptr, nullptr}};
const GEnumValue kProjections[] = {
    {number(Projection::kRectilinear), "Straight lines stay straight", "rectilinear"},
    {number(Projection::kCylindrical), "Verticals stay straight", "cylindrical"},
    {number(Projection::kEquirectangular), "Longitude and latitude", "equirectangular"},
    {number(Projection::kStereographic), "Small shapes keep their form", "stereographic"},
    {number(Projection::kPanini), "Verticals and lines through the middle stay straight", "panini"},
    {number(Projection::kFisheye), "Distance from the middle is the angle", "fisheye"},
    {0, nullptr, nullptr}};
const GEnumValue kInterpolations[] = {
    {number(Interpolation::kNearest), "Nearest pixel", "nearest"},
    {number(Interpolation::kBilinear), "Straight between 2 x 2 pixels", "bilinear"},
    {number(Interpolation::kBicubic), "Cubic through 4 x 4 pixels, Catmull-Rom", "bicubic"},
    {number(Interpolation::kLanczos), "Windowed sinc over 6 x 6 pixels", "lanczos"},
    {0, nullptr, nullptr}};
const GEnumValue kFills[] = {
    {number(Outside::kFill), "Black, opaque", "black"},
    {number(Outside::kReplicate), "The nearest pixel of the input's border", "replicate"},
    {number(Outside::kMirror), "The input, mirrored at its border", "mirror"},
    {0, nullptr, nullptr}};
const GEnumValue kDirections[] = {
    {number(Direction::kUndistort), "From the camera's picture to the view", "undistort"},
    {number(Direction::kDistort), "From the view back to the camera's picture", "distort"},
    {0, nullptr, nullptr}};

GType enum_type(const char* name, const GEnumValue* values) {
  GType type = g_type_from_name(name);
  if (type == 0) type = g_enum_register_static(name, values);
  gst_type_mark_as_plugin_api(type, static_cast<GstPluginAPIFlags>(0));
  return type;
}

GParamSpec* angle(const char* name, const char* nick, const char* blurb) {
  return g_param_spec_double(name, nick, blurb, -180, 180, 0, kAnimated);
}

}  // namespace

ViewOptions ViewSettings::view() const {
  ViewOptions options;
  options.alpha = alpha;
  options.alpha_mode = alpha_mode;
  options.projection = projection;
  options.zoom = zoom;
  options.pan = pan * kRadians;
  options.tilt = tilt * kRadians;
  options.roll = roll * kRadians;
  return options;
}

Sampling ViewSettings::sampling() const { return {interpolation, outside}; }

void install_view_properties(GObjectClass* object_class, guint first) {
  const auto install = [&](guint which, GParamSpec* spec) {
    g_object_class_install_property(object_class, first + which, spec);
  };
  install(kAlpha,
          g_param_spec_double(
              "alpha", "Alpha",
              "What the output shows. 0: the largest view without an invalid pixel; 1: every valid "
              "pixel of the input, at most 150 degrees where rectilinear; between: moves linearly "
              "from one to the other",
              0, 1, 0, kAnimated));
  install(kAlphaMode,
          g_param_spec_enum("alpha-mode", "Alpha Mode",
                            "What alpha means: as said there, or as OpenCV and cameraundistort "
                            "have it, where width and height are filled each by itself",
                            enum_type("GstCalibAlphaMode", kAlphaModes), 0, kMutablePlaying));
  install(kProjection,
          g_param_spec_enum("projection", "Projection", "How directions are laid out on the output",
                            enum_type("GstCalibProjection", kProjections), 0, kMutablePlaying));
  install(kZoom,
          g_param_spec_double(
              "zoom", "Zoom",
              "Factor by which what alpha chose is enlarged, around the middle of the output", 0.01,
              100, 1, kAnimated));
  install(kPan, angle("pan", "Pan", "Looks to the right, degrees"));
  install(kTilt, angle("tilt", "Tilt", "Looks up, degrees"));
  install(kRoll, angle("roll", "Roll", "Turns the view clockwise, degrees"));
  install(
      kDirection,
      g_param_spec_enum("direction", "Direction",
                        "Whether the camera's picture becomes the view (undistort), or what comes "
                        "in shows the view and becomes the camera's picture (distort)",
                        enum_type("GstCalibDirection", kDirections), 0, kMutablePlaying));
  install(kInterpolation, g_param_spec_enum("interpolation", "Interpolation",
                                            "Which pixels of the input make one of the output",
                                            enum_type("GstCalibInterpolation", kInterpolations),
                                            number(Interpolation::kBilinear), kMutablePlaying));
  install(kFill, g_param_spec_enum("fill", "Fill",
                                   "What is shown outside of the input; where the calibration is "
                                   "not valid it is black",
                                   enum_type("GstCalibFill", kFills), 0, kMutablePlaying));
  install(kThreads,
          g_param_spec_int(
              "n-threads", "Threads",
              "How many threads share the rows of a frame, the streaming thread among them", 1, 64,
              1, kMutablePlaying));
}

Field view_field(ViewSettings& settings, guint which) {
  switch (which) {
    case kAlpha:
      return settings.alpha;
    case kAlphaMode:
      return settings.alpha_mode;
    case kProjection:
      return settings.projection;
    case kZoom:
      return settings.zoom;
    case kPan:
      return settings.pan;
    case kTilt:
      return settings.tilt;
    case kRoll:
      return settings.roll;
    case kDirection:
      return settings.direction;
    case kInterpolation:
      return settings.interpolation;
    case kFill:
      return settings.outside;
    case kThreads:
      return settings.threads;
    default:
      return {};
  }
}

}  // namespace calvin::gst
