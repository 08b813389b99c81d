// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the cameras of a rig stand: extrinsic calibration of any number of cameras from boards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/core/export.hpp"
#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/rig_views.hpp"

namespace calvin {

enum class RigMode {
  // Two cameras or more see a board at one time, and it is shown in many places: all of them and
  // all boards in one least squares. The frame is that of the first camera.
  kJoint,
  // Every camera has seen the same board, which lies still, at any time; each is solved by itself.
  // The frame is that of the board.
  kFloor,
};

// What becomes of the intrinsics that are known of the cameras.
enum class RigIntrinsics {
  kHeld,   // they stay as they are; how well they are known is a part of the covariances
  kPrior,  // the views of the rig improve them: for pictures that they were not found from
  kFree,   // they are found anew, from these views alone; the lenses keep their models
};

struct RigOptions {
  RigMode mode = RigMode::kJoint;
  std::uint64_t tolerance = 10'000'000;  // ns, between pictures of one instant
  // Known distances between cameras. With them the size of boards is known to `board_sigma` only,
  // of their size (1 sigma, at most 1; 0: exactly), and lengths of the rig are those that explain
  // both best.
  std::vector<CameraBaseline> baselines = {};
  double board_sigma = 0.01;
  // kJoint: cameras that what they have seen does not join to the others are left out of the rig
  // instead of refusing it. The frame is that of the first camera in it.
  bool is_partial = false;
  // kJoint: the boards are fixed to each other, as on the faces of a box; how, is found. Cameras
  // are then joined that have seen different ones of them at one time.
  bool fixed_boards = false;
  RigIntrinsics intrinsics = RigIntrinsics::kHeld;  // kJoint
  // The frame of the rig; absent: as `mode` says.
  std::optional<RigWorld> world = {};
};

// A camera that is not in the rig.
struct LeftOutCamera {
  std::string camera;
  std::string reason;  // a sentence for the user, which says what to do
};

// Lengths on the boards, true over said, as known distances between cameras have them.
struct BoardScale {
  double scale = 1;
  double sigma = 0;
};

struct RigSolution {
  Rig rig;
  std::vector<RigLink> links;
  std::optional<std::size_t> weakest;  // of the links, the one that fewest views hold
  std::uint64_t farthest = 0;          // ns, between two pictures of one instant, at the most
  std::vector<RigView> rejected;       // contradict the others; by the cameras of the rig
  std::vector<LeftOutCamera> left_out;
  std::optional<BoardScale> board_scale;  // absent without known distances
  std::vector<std::string> remarks;       // sentences for the user
  // Where another frame was asked for: the rig in that of its first camera, or of the floor, where
  // errors of the world are no part of what is known of the cameras.
  std::optional<Rig> as_solved;
};

// The same views give the same numbers. kInvalidArgument for fewer than two cameras (one before a
// floor), names that are missing or there twice, broken calibrations, covariances or views, views
// of images of another size than the calibration's, a camera whose views all lack timestamps
// (kJoint), options out of range, and known distances or a world that are none of these cameras;
// kDegenerate where the views leave open where a camera stands: the message says which, and what to
// show.
[[nodiscard]] CALVIN_API Result<RigSolution> solve_rig(const std::vector<RigCameraViews>& cameras,
                                                       const RigOptions& options = {},
                                                       std::stop_token stop = {});

// Internal, and not exported: the rig as the views of boards are to be held against it, in the
// frame of the solve and in the lengths that boards are said to have.
[[nodiscard]] Rig in_board_lengths(const RigSolution& solution);

// One line: "'left' and 'right': 13 views, 99.3 mm apart (+-0.2), axes at 0.4 degrees, ...".
[[nodiscard]] CALVIN_API std::string to_text(const RigLink& link, const Rig& rig);

}  // namespace calvin
