// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The loop from the base of a robot over its hand, the camera and the board back to the base, which
// every view closes. Internal.
#pragma once

#include <Eigen/Core>

#include "calvin/core/hand_eye.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin::rig {

// What all views share. A length on the board, in metres of the robot, is `scale` times what the
// board says.
struct HandEyePlaces {
  SE3 mount_from_camera;
  SE3 carrier_from_board;
  double scale = 1;
};

// The unknowns of HandEyePlaces as columns: a turn from the left (rad) and a place (m) of each of
// the two poses, added to it, then the scale.
inline constexpr int kMountColumn = 0;
inline constexpr int kCarrierColumn = 6;
inline constexpr int kScaleColumn = 12;
inline constexpr int kPlaceColumns = 13;

// The places moved by such a step.
[[nodiscard]] HandEyePlaces moved(const HandEyePlaces& places, const double* step);

// base_from_hand where a camera sees the board at camera_from_board.
[[nodiscard]] SE3 expected_hand(const HandEyePlaces& places, EyeSetup setup,
                                const SE3& camera_from_board);

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// How far the expected hand is from the measured one: the turn between them about the axes of the
// base (rad), then the place (m).
[[nodiscard]] Vector6d hand_error(const SE3& expected, const SE3& measured);

struct LoopRows {
  Vector6d error;                                     // hand_error()
  Matrix6d by_board;                                  // d of camera_from_board as in retract()
  Eigen::Matrix<double, 6, kPlaceColumns> by_places;  // as in moved()
};
[[nodiscard]] LoopRows loop_rows(const HandEyePlaces& places, EyeSetup setup,
                                 const SE3& camera_from_board, const SE3& base_from_hand);

}  // namespace calvin::rig
