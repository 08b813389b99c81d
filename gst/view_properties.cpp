// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "view_properties.hpp"

#include <numbers>

#include "properties.hpp"

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
const GEnumValue kDirections[] = {{0, "From the camera's picture to the view", "undistort"},
                                  {1, "From the view back to the camera's picture", "distort"},
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

bool set_view_property(ViewSettings& settings, guint which, const GValue* value) {
  switch (which) {
    case kAlpha:
      settings.alpha = g_value_get_double(value);
      return true;
    case kAlphaMode:
      settings.alpha_mode = static_cast<AlphaMode>(g_value_get_enum(value));
      return true;
    case kProjection:
      settings.projection = static_cast<Projection>(g_value_get_enum(value));
      return true;
    case kZoom:
      settings.zoom = g_value_get_double(value);
      return true;
    case kPan:
      settings.pan = g_value_get_double(value);
      return true;
    case kTilt:
      settings.tilt = g_value_get_double(value);
      return true;
    case kRoll:
      settings.roll = g_value_get_double(value);
      return true;
    case kDirection:
      settings.distort = g_value_get_enum(value) != 0;
      return true;
    case kInterpolation:
      settings.interpolation = static_cast<Interpolation>(g_value_get_enum(value));
      return true;
    case kFill:
      settings.outside = static_cast<Outside>(g_value_get_enum(value));
      return true;
    case kThreads:
      settings.threads = g_value_get_int(value);
      return true;
    default:
      return false;
  }
}

bool get_view_property(const ViewSettings& settings, guint which, GValue* value) {
  switch (which) {
    case kAlpha:
      g_value_set_double(value, settings.alpha);
      return true;
    case kAlphaMode:
      g_value_set_enum(value, number(settings.alpha_mode));
      return true;
    case kProjection:
      g_value_set_enum(value, number(settings.projection));
      return true;
    case kZoom:
      g_value_set_double(value, settings.zoom);
      return true;
    case kPan:
      g_value_set_double(value, settings.pan);
      return true;
    case kTilt:
      g_value_set_double(value, settings.tilt);
      return true;
    case kRoll:
      g_value_set_double(value, settings.roll);
      return true;
    case kDirection:
      g_value_set_enum(value, settings.distort ? 1 : 0);
      return true;
    case kInterpolation:
      g_value_set_enum(value, number(settings.interpolation));
      return true;
    case kFill:
      g_value_set_enum(value, number(settings.outside));
      return true;
    case kThreads:
      g_value_set_int(value, settings.threads);
      return true;
    default:
      return false;
  }
}

}  // namespace calvin::gst
