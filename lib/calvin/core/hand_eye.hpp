// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// HandEye: a camera that knows where it is on a robot, or before one. Data only: rig/ finds it, io/
// has its file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"

namespace calvin {

enum class EyeSetup {
  kInHand,  // the camera is on the hand of the robot, and the board stands still
  kToHand,  // the camera stands still, and the board is on the hand
};

// A length over another one, such as one of the robot over that of the board, which is 1 where both
// have the same metre.
struct LengthRatio {
  double value = 1;
  double sigma = 0;
};

struct HandEye {
  EyeSetup setup = EyeSetup::kInHand;
  Calibration calibration;
  // hand_from_camera or base_from_camera, and what is found with it: base_from_board or
  // hand_from_board. `mount` is what the camera is fixed to, `carrier` what the board is.
  Pose mount_from_camera;
  Pose carrier_from_board;
  // Row-major, 6 x 6, as RigCamera has it: of a turn about the axes of the mount or carrier (rad),
  // then of the place in it (m).
  std::vector<double> mount_covariance;
  std::vector<double> carrier_covariance;

  int poses = 0;              // of the robot, those in use
  std::optional<double> rms;  // px, of all corners in use
  // Root mean squares of the angle (rad) and the distance (m) between where the robot said that its
  // hand was and where the camera, which saw the board, puts it.
  double loop_turn = 0;
  double loop_place = 0;
  double corner_factor = 1;  // what corners are off by, over their sigmas
  // 1 sigma per axis of a pose of the robot, rad and m: as given, or as found.
  double robot_turn_sigma = 0;
  double robot_place_sigma = 0;
  std::optional<LengthRatio> scale;  // absent where the robot has turned its hand only
  // How much farther apart the rows of the board are than its columns; absent where the board is
  // believed.
  std::optional<LengthRatio> aspect;
  std::vector<std::string> remarks;  // sentences for the user
};

}  // namespace calvin
