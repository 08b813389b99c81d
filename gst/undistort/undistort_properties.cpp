// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of the properties of calibundistort.

#include "undistort/undistort_properties.hpp"

namespace calvin::gst {

namespace {

constexpr GEnumValue kAlphaModes[] = {
    choice(AlphaMode::kCalvin, "calvin", "The largest view; pixels keep their aspect"),
    choice(AlphaMode::kOpenCv, "opencv", "What cameraundistort shows"), kNoMoreChoices};
constexpr GEnumValue kProjections[] = {
    choice(Projection::kRectilinear, "rectilinear", "Straight lines stay straight"),
    choice(Projection::kCylindrical, "cylindrical", "Verticals stay straight"),
    choice(Projection::kEquirectangular, "equirectangular", "Longitude and latitude"),
    choice(Projection::kStereographic, "stereographic", "Small shapes keep their form"),
    choice(Projection::kPanini, "panini", "Verticals and lines through the middle stay straight"),
    choice(Projection::kFisheye, "fisheye", "Distance from the middle is the angle"),
    kNoMoreChoices};
constexpr GEnumValue kDirections[] = {
    choice(Direction::kUndistort, "undistort", "From the camera's picture to the view"),
    choice(Direction::kDistort, "distort", "From the view back to the camera's picture"),
    kNoMoreChoices};
constexpr GEnumValue kSides[] = {
    choice(Rectify::kNone, "none", "The camera has a view of its own"),
    choice(Rectify::kLeft, "left", "The frames are of the left, or upper, camera of the pair"),
    choice(Rectify::kRight, "right", "The frames are of the right, or lower, camera"),
    kNoMoreChoices};
constexpr GEnumValue kInterpolations[] = {
    choice(Interpolation::kNearest, "nearest", "Nearest pixel"),
    choice(Interpolation::kBilinear, "bilinear", "Straight between 2 x 2 pixels"),
    choice(Interpolation::kBicubic, "bicubic", "Cubic through 4 x 4 pixels, Catmull-Rom"),
    choice(Interpolation::kLanczos, "lanczos", "Windowed sinc over 6 x 6 pixels"), kNoMoreChoices};
constexpr GEnumValue kFills[] = {
    choice(Outside::kFill, "black", "Black, opaque"),
    choice(Outside::kReplicate, "replicate", "The nearest pixel of the input's border"),
    choice(Outside::kMirror, "mirror", "The input, mirrored at its border"), kNoMoreChoices};

constexpr Range kDegrees = {-180, 180};
constexpr Range kPositions = {-1e9, 1e9};  // as of a zoom table

template <auto kMember>
constexpr auto in_view = kept_in<&UndistortSettings::view, kMember>;
template <auto kMember>
constexpr auto in_lens = kept_in<&UndistortSettings::lens, kMember>;

// The file is read again, though it may be the one that was named before.
void calibration_was_set(UndistortSettings& settings, bool /*to_another*/) {
  settings.calibration_was_set = true;
}

template <auto kFlag>
void lens_was_set(UndistortSettings& settings, bool /*to_another*/) {
  settings.lens.*kFlag = true;
}

constexpr Property<UndistortState> kRows[] = {
    {"calibration",
     "Calibration",
     "The calibration: a file (native JSON, OpenCV, ROS, Kalibr, mrcal, COLMAP, caliscope, "
     "Bouguet), which may appear later and is read again when it is replaced; or JSON text; or the "
     "settings of cameraundistort; or a list "
     "such as fx=500,fy=500,cx=319.5,cy=239.5,k1=-0.2,width=640,height=480. Empty: the "
     "calibration event of an element upstream. The file or text of a zoom table (calvin-zoom "
     "writes "
     "it) is followed as the lens moves, see zoom-position",
     kept_in<&UndistortSettings::calibration>,
     {.other_name = "settings", .was_set = calibration_was_set}},
    {"settings",
     "Settings",
     "The same as calibration, by the name that cameraundistort has for it: its pipelines work "
     "with this element in its place",
     kept_in<&UndistortSettings::calibration>,
     {.other_name = "calibration", .was_set = calibration_was_set}},
    {"zoom-position",
     "Zoom Position",
     "Where the zoom of the lens stands, in the units of the zoom table in calibration; zoom is "
     "another thing, of the view. Never set: as device says",
     in_lens<&LensSettings::zoom>,
     {.range = kPositions,
      .flags = kAnimated,
      .was_set = lens_was_set<&LensSettings::zoom_was_set>}},
    {"focus-position",
     "Focus Position",
     "Where the focus of the lens stands, in the units of the zoom table, which counts where that "
     "has "
     "several settings of the focus at one zoom. Never set: as device says",
     in_lens<&LensSettings::focus>,
     {.range = kPositions,
      .flags = kAnimated,
      .was_set = lens_was_set<&LensSettings::focus_was_set>}},
    {"device",
     "Device",
     "V4L2 node of the camera, such as /dev/video0, that is asked ten times a second where its "
     "lens "
     "stands (zoom_absolute and focus_absolute), for a zoom table in calibration (unset = not "
     "read)",
     in_lens<&LensSettings::device>,
     {.flags = kMutableReady}},
    {"enabled",
     "Enabled",
     "Undistort; off: the frames pass through untouched, or scaled where the output has another "
     "size",
     kept_in<&UndistortSettings::enabled>,
     {.other_name = "undistort"}},
    {"undistort",
     "Undistort",
     "The same as enabled, by the name that cameraundistort has for it",
     kept_in<&UndistortSettings::enabled>,
     {.other_name = "enabled"}},
    {"output-calibration", "Output Calibration",
     "The calibration of the output as native JSON: a pinhole camera (or an ideal fisheye, where "
     "that is the projection) while it is undistorted, what came from upstream while it passes "
     "through or is scaled; empty where no model describes the projection",
     returned_by<&UndistortState::output_calibration>},
    {"alpha",
     "Alpha",
     "What the output shows. 0: the largest view without an invalid pixel; 1: every valid pixel "
     "of the input, at most 150 degrees where rectilinear; between: moves linearly from one to "
     "the other",
     in_view<&ViewSettings::alpha>,
     {.range = Range{0, 1}, .flags = kAnimated}},
    {"alpha-mode",
     "Alpha Mode",
     "What alpha means: as said there, or as OpenCV and cameraundistort have it, where width and "
     "height are filled each by itself",
     in_view<&ViewSettings::alpha_mode>,
     {.choices = {"GstCalibAlphaMode", kAlphaModes}}},
    {"projection",
     "Projection",
     "How directions are laid out on the output",
     in_view<&ViewSettings::projection>,
     {.choices = {"GstCalibProjection", kProjections}}},
    {"zoom",
     "Zoom",
     "Factor by which what alpha chose is enlarged, around the middle of the output",
     in_view<&ViewSettings::zoom>,
     {.range = Range{0.01, 100}, .flags = kAnimated}},
    {"pan",
     "Pan",
     "Looks to the right, degrees",
     in_view<&ViewSettings::pan>,
     {.range = kDegrees, .flags = kAnimated}},
    {"tilt",
     "Tilt",
     "Looks up, degrees",
     in_view<&ViewSettings::tilt>,
     {.range = kDegrees, .flags = kAnimated}},
    {"roll",
     "Roll",
     "Turns the view clockwise, degrees",
     in_view<&ViewSettings::roll>,
     {.range = kDegrees, .flags = kAnimated}},
    {"direction",
     "Direction",
     "Whether the camera's picture becomes the view (undistort), or what comes in shows the view "
     "and becomes the camera's picture (distort)",
     in_view<&ViewSettings::direction>,
     {.choices = {"GstCalibDirection", kDirections}}},
    {"rectify",
     "Rectify",
     "Turns the view so that its rows are those of the other camera of a stereo pair. calibration "
     "is then the file or text of a rig of two cameras (calvin-rig and calibrig write it), empty: "
     "the calvin-rig event of an element upstream. Wants rectilinear; alpha counts for both "
     "cameras, alpha-mode for nothing",
     kept_in<&UndistortSettings::rectify>,
     {.choices = {"GstCalibRectify", kSides}}},
    {"interpolation",
     "Interpolation",
     "Which pixels of the input make one of the output",
     in_view<&ViewSettings::interpolation>,
     {.choices = {"GstCalibInterpolation", kInterpolations}}},
    {"fill",
     "Fill",
     "What is shown outside of the input; where the calibration is not valid it is black",
     in_view<&ViewSettings::outside>,
     {.choices = {"GstCalibFill", kFills}}},
    {"n-threads",
     "Threads",
     "How many threads share the rows of a frame, the streaming thread among them",
     in_view<&ViewSettings::threads>,
     {.range = Range{1, 64}}},
};

}  // namespace

constinit const Properties<UndistortState> kUndistortProperties = kRows;

}  // namespace calvin::gst
