// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of the properties of calibdetect.

#include "detect/detector_properties.hpp"

#include "elements.hpp"

namespace calvin::gst {

namespace {

constexpr GEnumValue kModes[] = {
    choice(kModeAuto, "auto", "Async when the source is live, sync otherwise"),
    choice(kModeSync, "sync", "The streaming thread waits: each frame carries its own corners"),
    choice(kModeAsync, "async", "Nothing waits: newest frame only, corners ride on a later frame"),
    kNoMoreChoices};

void board_was_set(DetectorSettings& settings, bool to_another) {
  settings.board_changed |= to_another;
}

void recheck_was_set(DetectorSettings& settings, bool to_another) {
  settings.recheck_changed |= to_another;
}

constexpr Property<CalibDetector> kRows[] = {
    {"board",
     "Board",
     "The board to find, checkerboard:COLSxROWS:SIZE[:circles] or puzzle:COLSxROWS:SIZE with inner "
     "corners "
     "and the side of a square, charuco:COLSxROWS:SIZE:MARKER:DICTIONARY with squares, "
     "aprilgrid:COLSxROWS:SIZE:GAP, aruco:COLSxROWS:SIZE:GAP:DICTIONARY or "
     "apriltag:FAMILY:COLSxROWS:SIZE:GAP with tags, apriltag:FAMILY:SIZE:ID=X,Y+ID=X,Y with tags "
     "at "
     "these places, circles:COLSxROWS:SIZE, "
     "acircles:COLSxROWS:SIZE or "
     "dots:COLSxROWS:SIZE:rings=COL.ROW with the distance of circles, dots:SIZE or lines:SIZE, of "
     "which any part is in view, dot, a light, or "
     "wand:DISTANCE+DISTANCE, three on a line, moved before a camera that stands still, or "
     "FILE.json#NAME; several separated by ;. auto, or "
     "auto:SIZE, takes what is in view when it is certain which one it is, puzzle:auto "
     "any PuzzleBoard",
     kept_in<&DetectorSettings::board>,
     {.was_set = board_was_set}},
    {"camera", "Camera", "Name of the camera in metas, messages and files",
     kept_in<&DetectorSettings::camera>},
    {"mode",
     "Mode",
     "Whether frames wait for the detector; decided anew at each format",
     kept_in<&DetectorSettings::mode>,
     {.choices = {"GstCalibDetectMode", kModes}}},
    {"max-rate",
     "Maximum Rate",
     "Frames per second of running time to look at, at the most (0 = all)",
     kept_in<&DetectorSettings::max_rate>,
     {.range = Range{0, 1000}}},
    {"post-messages", "Post Messages",
     "Post a calib-detection message for every board and frame looked at",
     kept_in<&DetectorSettings::post_messages>},
    {"recheck",
     "Recheck",
     "A calibration (a file, or whatever calibundistort takes) that each board found is held "
     "against: posts calib-check with the misfit, how far the camera has moved from it, and the "
     "pose of the board",
     kept_in<&DetectorSettings::recheck>,
     {.was_set = recheck_was_set}},
    {"stats", "Statistics",
     "Counts of frames since start: frames, detections, skipped (by max-rate, or as the worker "
     "was busy)",
     returned_by<&CalibDetector::stats>},
};

}  // namespace

constinit const Properties<CalibDetector> kDetectorProperties = kRows;

std::vector<GParamSpec*> new_calibdetect_specs() { return new_specs(kDetectorProperties); }

}  // namespace calvin::gst
