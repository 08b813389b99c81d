// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibrig and their choices.

#include "rig/rig_solver.hpp"

namespace calvin::gst {

namespace {

constexpr GEnumValue kModes[] = {
    choice(kRigFloor, "floor",
           "One board lies still, and each camera has seen it: its frame is that of the rig"),
    choice(kRigJoint, "joint",
           "A board is carried before two cameras or more at a time: the frame is that of the "
           "first"),
    choice(kRigStereo, "stereo", "As joint, of two cameras"), kNoMoreChoices};

constexpr GEnumValue kMethods[] = {
    choice(RigMethod::kAuto, "auto", "By a light where one is seen first, else by boards"),
    choice(RigMethod::kBoards, "boards", "By boards alone, before cameras whose lenses are known"),
    choice(RigMethod::kSvoboda, "svoboda",
           "By a light alone (board=dot of calibdetect), lenses and places: that of BlueCCal"),
    kNoMoreChoices};

constexpr GEnumValue kIntrinsics[] = {
    choice(RigIntrinsics::kHeld, "no",
           "They stay as they are; how well they are known is a part of the result"),
    choice(RigIntrinsics::kPrior, "prior",
           "What was known of them counts, with its sigmas: for views that it was not found from"),
    choice(RigIntrinsics::kFree, "free", "By the views of the rig alone"), kNoMoreChoices};

}  // namespace

const Property<RigSolver> kRigProperties[16] = {
    {"board",
     "Board",
     "The boards that count, as board of calibdetect takes them, in any spelling; none: every "
     "board",
     kept_in<&RigSettings::board>,
     {.flags = kMutableReady}},
    {"mode",
     "Mode",
     "How the places of the cameras are found",
     kept_in<&RigSettings::mode>,
     {.choices = {"GstCalibRigMode", kModes}, .flags = kMutableReady}},
    {"method",
     "Method",
     "What tells where the cameras are",
     kept_in<&RigSettings::method>,
     {.choices = {"GstCalibRigMethod", kMethods}, .flags = kMutableReady}},
    {"location",
     "Location",
     "The file of the rig; written at the first solve, then at every one. What was there before is "
     "kept as FILE~",
     kept_in<&RigSettings::location>,
     {.flags = kMutableReady}},
    {"export",
     "Export",
     "Further files, written with location: FORMAT:PATH,FORMAT:PATH; kalibr, caliscope and calvin "
     "are files, mrcal and colmap folders; of two cameras also opencv (a file or FOLDER/) and ros "
     "(a folder)",
     kept_in<&RigSettings::exports>,
     {.flags = kMutableReady}},
    {"tolerance",
     "Tolerance",
     "How far pictures of one instant may be apart (ns)",
     kept_in<&RigSettings::tolerance>,
     {.range = Range{0, 1e10}, .flags = kMutableReady}},
    {"baseline",
     "Baseline",
     "Known distances between cameras, as left:right:110.03mm:0.05mm (the last is its sigma; none: "
     "exactly), separated by commas, or of two cameras 110.03mm. They tell how large boards are, "
     "and the unit before a light",
     kept_in<&RigSettings::baseline>,
     {.flags = kMutableReady}},
    {"board-sigma",
     "Board Sigma",
     "With a known distance: how well the size of boards is known, 1 sigma, 0..1 of it (0 = "
     "exactly)",
     kept_in<&RigSettings::board_sigma>,
     {.range = Range{0, 1}, .flags = kMutableReady}},
    {"world",
     "World",
     "The frame of the rig: the name of a camera, board (where it was at the first instant), "
     "board:SECONDS or board:last, and quarter turns of the axes, as board:x180 with z up from a "
     "board on the floor; none: the first camera, and with mode=floor the board",
     kept_in<&RigSettings::world>,
     {.flags = kMutableReady}},
    {"fixed-boards",
     "Fixed Boards",
     "Whether the boards are fixed to each other, as on the sides of a box: cameras that see "
     "different ones at one time are joined. How the boards lie is found where one camera sees two",
     kept_in<&RigSettings::fixed_boards>,
     {.flags = kMutableReady}},
    {"estimate-intrinsics",
     "Estimate Intrinsics",
     "Before boards that are carried: whether the lenses are found together with the places",
     kept_in<&RigSettings::intrinsics>,
     {.choices = {"GstCalibRigIntrinsics", kIntrinsics}, .flags = kMutableReady}},
    {"places",
     "Places",
     "Before a light: a file of where some cameras stand, lines 'name x y z' in m. Three or more "
     "give the frame of the rig, two its unit; none: the first camera is the rig, without a unit",
     kept_in<&RigSettings::places>,
     {.flags = kMutableReady}},
    {"model",
     "Model",
     "Before a light: the lens of cameras without intrinsics, one that is a pinhole where its "
     "coefficients are 0",
     kept_in<&RigSettings::model>,
     {.flags = kMutableReady}},
    {"fix",
     "Fix",
     "Before a light: what is held of that lens, separated by commas: aspect, center, cx, cy and "
     "coefficients, or none",
     kept_in<&RigSettings::fix>,
     {.flags = kMutableReady}},
    {"center-sigma",
     "Center Sigma",
     "Before a light: how far the axis of that lens may be from the middle of a picture, 1 sigma, "
     "0..1 of its width (0 = by any distance)",
     kept_in<&RigSettings::center_sigma>,
     {.range = Range{0, 1}, .flags = kMutableReady}},
    {"wand-sigma",
     "Wand Sigma",
     "Before a wand of lights: how well the place of each along it is known, 1 sigma in m (0 = "
     "exactly)",
     kept_in<&RigSettings::wand_sigma>,
     {.range = Range{0, 1}, .flags = kMutableReady}},
};

}  // namespace calvin::gst
