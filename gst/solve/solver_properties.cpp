// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of the properties of calibsolve.

#include "solve/solver_properties.hpp"

#include <string>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/solve/methods/methods.hpp"
#include "elements.hpp"

namespace calvin::gst {

namespace {

// Blurbs that list what the library has. They are never freed: GObject keeps the pointers.
const char* model_blurb() {
  static const auto& kBlurb = *new std::string(
      fmt::format("Camera model: {}, or auto for the simplest one that tells all views",
                  join(model_names(), ", ")));
  return kBlurb.c_str();
}

const char* method_blurb() {
  static const auto& kBlurb = *new std::string(
      fmt::format("Where the solve starts: by a method of the tools that came before ({}; those of "
                  "one view are calvin-solve's); unset: starts are searched",
                  join(methods_of_several_views(), ", ")));
  return kBlurb.c_str();
}

const char* export_blurb() {
  static const auto& kBlurb = *new std::string(
      fmt::format("Further files in other formats, FORMAT:PATH,FORMAT:PATH with the formats {}",
                  join(calibration_formats(), ", ")));
  return kBlurb.c_str();
}

constexpr GEnumValue kCaptureModes[] = {
    choice(CaptureChoice::kDefault, "default", "All when the source is not live, auto when it is"),
    choice(CaptureChoice::kAll, "all", "Every view with a board; only outliers are dropped"),
    choice(CaptureChoice::kAuto, "auto", "Views that are still, large and unlike those before"),
    choice(CaptureChoice::kManual, "manual", "Only on the signal capture-view"), kNoMoreChoices};

constexpr GEnumValue kBoardShapes[] = {
    choice(BoardShapeChoice::kNone, "none", "The board is as it was printed, and flat"),
    choice(BoardShapeChoice::kWarp, "warp", "Two curvatures, from 8 views of one board on"),
    choice(BoardShapeChoice::kPoints, "points", "Every control point, from 8 views on"),
    choice(BoardShapeChoice::kAuto, "auto",
           "The measured shape of a named board that has one; warp for any other"),
    kNoMoreChoices};

constexpr Property<CalibSolver> kRows[] = {
    {"location", "Location",
     "File for the calibration (native JSON), written at the first solve and whenever it got "
     "better; that of another session is replaced by one as good, or by the final result where "
     "views contradict it",
     kept_in<&SessionSettings::location>},
    {"export", "Export", export_blurb, kept_in<&SessionSettings::exports>},
    {"overwrite", "Overwrite",
     "Replace what location and export hold of another session though it is better; it is kept "
     "as FILE~",
     kept_in<&SessionSettings::overwrite>},
    {"journal",
     "Journal",
     "File that every view is written to before it is announced, and from which the next run takes "
     "them up again (JSON lines); one for each camera",
     kept_in<&SessionSettings::journal>,
     {.flags = kMutableReady}},
    {"device",
     "Device",
     "V4L2 node of the camera, such as /dev/video0: where its lens stands is kept with the "
     "calibration, and autofocus and a lens that is moved are told of (unset = not read)",
     kept_in<&SessionSettings::device>,
     {.flags = kMutableReady}},
    {"camera", "Camera",
     "Name of the camera in messages and files (unset = the one that the observations carry)",
     kept_in<&SessionSettings::camera>},
    {"model", "Model", model_blurb, kept_in<&SessionSettings::model>},
    {"method", "Method", method_blurb, kept_in<&SessionSettings::method>},
    {"fix", "Fix",
     "What not to estimate, separated by commas: a parameter, held at its value in initial, or "
     "else a distortion coefficient at 0 (beta at 1) and cx, cy (center for both) at the middle "
     "of the picture. What to tie: aspect (fy:fx as in initial, or else 1), fx=fy, k1=k2. fx=800 "
     "holds at a number. all holds the whole camera of initial, and tells where boards are",
     kept_in<&SessionSettings::fix>},
    {"initial", "Initial",
     "A calibration (a file, or whatever calibundistort takes) to start the solve from, which "
     "also gives the values that fix holds; unset: the views alone tell",
     kept_in<&SessionSettings::initial>},
    {"board", "Board",
     "The board of the views as calibdetect has it: of FILE.json#NAME the measured shape is used, "
     "where there is one (calvin-board measure). Other texts say nothing here",
     kept_in<&SessionSettings::board>},
    {"points", "Points",
     "Points whose pixels are chosen by clicks, in their order: a file of points, of which rows "
     "with "
     "u v are chosen already, or a board that cannot be found (unset: those of board=points:FILE)",
     kept_in<&SessionSettings::points>},
    {"board-shape",
     "Board Shape",
     "What is estimated of the shape of the board",
     kept_in<&SessionSettings::board_shape>,
     {.choices = {"GstCalibSolveBoardShape", kBoardShapes}}},
    {"warp", "Warp", "Deprecated: false is board-shape=none", kept_in<&SessionSettings::warp>},
    {"skew", "Skew", "Estimate the skew of the pixel axes too", kept_in<&SessionSettings::skew>},
    {"capture-mode",
     "Capture Mode",
     "Which views of the board are kept",
     kept_in<&SessionSettings::capture_mode>,
     {.choices = {"GstCalibSolveCaptureMode", kCaptureModes}}},
    {"min-views",
     "Minimum Views",
     "Views that a calibration needs at least",
     kept_in<&SessionSettings::min_views>,
     {.range = Range{2, 1000}}},
    {"max-views",
     "Maximum Views",
     "Views that are kept at most: with them the final result is posted or, while target-error is "
     "not reached, a view that tells more takes the place of one that tells less (0 = no limit)",
     kept_in<&SessionSettings::max_views>,
     {.range = Range{0, 100000}}},
    {"target-error",
     "Target Error",
     "Expected error in px (1 sigma, where corners were seen) at which nothing more is captured "
     "and the final result is posted (0 = never)",
     kept_in<&SessionSettings::target_error>,
     {.range = Range{0, 100}}},
    {"readout-time",
     "Readout Time",
     "Time in ns that the camera takes from the first row of a frame to the last, by which corners "
     "of a moving board are mended (0 = not known, estimated where the board moves; 1 = all rows "
     "at once)",
     kept_in<&SessionSettings::readout_time>,
     {.range = Range{0, GST_SECOND}}},
    {"runs",
     "Runs",
     "Solves that make a final result: before each after the first one the corners of views taken "
     "since it is set are looked at again, as lens and pose let them be seen",
     kept_in<&SessionSettings::runs>,
     {.range = Range{1, 20}, .other_name = "refinements"}},
    {"refinements",
     "Refinements",
     "Number of times that the corners are looked at again for a final result: runs less one",
     returned_by<&CalibSolver::refinements, &CalibSolver::set_refinements>,
     {.range = Range{0, 19}, .other_name = "runs"}},
    {"calibration", "Calibration",
     "The newest calibration as native JSON (unset before the first solve)",
     returned_by<&CalibSolver::calibration_json>},
    {"stats", "Statistics", "State of the session: views, coverage 0..1, rms px, expected-error px",
     returned_by<&CalibSolver::stats>},
};

}  // namespace

constinit const Properties<CalibSolver> kSolverProperties = kRows;

std::vector<GParamSpec*> new_calibsolve_specs() { return new_specs(kSolverProperties); }

}  // namespace calvin::gst
