// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The settings of calibrig, and what is wrong with them whatever the cameras will see.
#pragma once

#include <string>
#include <vector>

#include <gst/gst.h>

#include "calvin/core/text.hpp"
#include "calvin/rig/light_camera.hpp"
#include "calvin/session/rig/rig_session.hpp"

namespace calvin::gst {

enum RigModeChoice { kRigFloor, kRigJoint, kRigStereo };

struct RigSettings {
  std::string board;
  RigModeChoice mode = kRigJoint;
  RigMethod method = RigMethod::kAuto;
  std::string location;
  std::string exports;  // "FORMAT:PATH,...", as parse_rig_exports() takes it
  guint64 tolerance = 10 * GST_MSECOND;
  std::string baseline;  // known distances, as parse_camera_baselines() takes them
  std::string world;     // the frame, as parse_rig_world() takes it
  double board_sigma = RigOptions().board_sigma;
  bool fixed_boards = false;
  RigIntrinsics intrinsics = RigIntrinsics::kHeld;
  // Before a light:
  std::string places;  // a file
  std::string model = LightOptions().model;
  std::string fix = join(LightOptions().fix, ",");
  double center_sigma = LightOptions().center_sigma;
  double wand_sigma = LightOptions().wand_sigma;  // m
};

// What the session is to know. An error for settings that cannot be read, and for those that
// contradict each other.
[[nodiscard]] Result<RigSessionSettings> session_settings(const RigSettings& now);

// The names of the cameras that are there, and of pads that may yet become cameras as well.
struct RigNames {
  std::vector<std::string> cameras;
  std::vector<std::string> pads;
};
// An error where no rig comes of these cameras.
[[nodiscard]] Status check_cameras(RigModeChoice mode, const RigOptions& options,
                                   const std::vector<std::string>& names);
// An error where the settings name a camera that none of the pads is; one pad alone says nothing of
// those that come.
[[nodiscard]] Status check_named(const RigOptions& options, const std::vector<std::string>& pads);

// An error for settings by which no rig comes of a light.
[[nodiscard]] Status check_light(const RigOptions& options, const LightOptions& light);

}  // namespace calvin::gst
