// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of the properties of calibtestsrc.

#include "testsrc/test_properties.hpp"

namespace calvin::gst {

namespace {

constexpr GEnumValue kMotions[] = {
    choice(MotionKind::kRandom, "random",
           "Independent poses all over the image: one per frame, when live one per 0.5 s"),
    choice(MotionKind::kOrbit, "orbit", "The camera circles the board in 10 s"),
    choice(MotionKind::kHand, "hand", "A smooth path as of a board held by hand"),
    choice(MotionKind::kStatic, "static", "One pose"), kNoMoreChoices};

constexpr Property<TestState> kRows[] = {
    {"board",
     "Board",
     "The board to render, checkerboard:COLSxROWS:SIZE[:circles] or puzzle:COLSxROWS:SIZE with "
     "inner corners "
     "and the side of a square, charuco:COLSxROWS:SIZE:MARKER:DICTIONARY with squares, "
     "aprilgrid:COLSxROWS:SIZE:GAP, aruco:COLSxROWS:SIZE:GAP:DICTIONARY or "
     "apriltag:FAMILY:COLSxROWS:SIZE:GAP with tags, apriltag:FAMILY:SIZE:ID=X,Y+ID=X,Y with tags "
     "at "
     "these places, circles:COLSxROWS:SIZE, "
     "acircles:COLSxROWS:SIZE or "
     "dots:COLSxROWS:SIZE:rings=COL.ROW with the distance of circles, dots:SIZE or lines:SIZE, of "
     "which any part is in view, dot, a light, "
     "wand:DISTANCE+DISTANCE, several on a line, or FILE.json#NAME",
     kept_in<&TestSettings::scene, &SceneSettings::board>,
     {.flags = kMutableReady}},
    {"calibration",
     "Calibration",
     "The camera to be: a calibration file, its content, or a list "
     "fx=..,fy=..,cx=..,cy=..,k1=..,width=..,height=..; unset: a brown5 camera 70 degrees wide, "
     "for any size",
     kept_in<&TestSettings::scene, &SceneSettings::calibration>,
     {.flags = kMutableReady}},
    {"rig",
     "Rig",
     "The file of a rig, or its JSON: then the camera is one of that, and the board moves before "
     "the "
     "first of them; calibration says nothing",
     kept_in<&TestSettings::scene, &SceneSettings::rig>,
     {.flags = kMutableReady}},
    {"camera",
     "Camera",
     "The name of the camera in the rig; unset: the first one",
     kept_in<&TestSettings::scene, &SceneSettings::camera>,
     {.flags = kMutableReady}},
    {"motion",
     "Motion",
     "How the board moves before the camera",
     kept_in<&TestSettings::scene, &SceneSettings::motion>,
     {.choices = {"GstCalibTestSrcMotion", kMotions}, .flags = kMutableReady}},
    {"noise",
     "Noise",
     "Noise of the sensor in grey levels of 255, 1 sigma",
     kept_in<&TestSettings::render, &RenderOptions::noise>,
     {.range = Range{0, 100}}},
    {"blur",
     "Blur",
     "Gaussian blur of the optics in px, 1 sigma",
     kept_in<&TestSettings::render, &RenderOptions::blur>,
     {.range = Range{0, 50}}},
    {"exposure",
     "Exposure",
     "Factor on all grey levels; those above 255 are cut off",
     kept_in<&TestSettings::render, &RenderOptions::exposure>,
     {.range = Range{0, 100}}},
    {"lamps",
     "Lamps",
     "Number of lamps that stand still behind a light (board=dot), as bright as that",
     kept_in<&TestSettings::render, &RenderOptions::lamps>,
     {.range = Range{0, 100}}},
    {"seed",
     "Seed",
     "Choice of the poses and the noise, never of the camera",
     kept_in<&TestSettings::scene, &SceneSettings::seed>,
     {.flags = kMutableReady}},
    {"ground-truth",
     "Ground Truth",
     "File to write the camera to, as a calibration; unset: none",
     kept_in<&TestSettings::ground_truth>,
     {.flags = kMutableReady}},
    {"readout-time",
     "Readout Time",
     "Time in ns from the first row of a frame to the last, as of a rolling shutter, in which an "
     "orbit or a hand goes on moving (0 = all at once)",
     kept_in<&TestSettings::readout_time>,
     {.range = Range{0, GST_SECOND}}},
    {"is-live",
     "Is Live",
     "Deliver frames in real time, as a camera does",
     returned_by<&TestState::is_live, &TestState::set_live>,
     {.flags = kMutableReady}},
};

}  // namespace

constinit const Properties<TestState> kTestProperties = kRows;

}  // namespace calvin::gst
