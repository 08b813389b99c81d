// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where camera and board are on a robot, about: every tilt of a plane and every labelling of a
// board is tried against the motions of the hand. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calvin/rig/board_views.hpp"
#include "calvin/rig/hand_eye/loop.hpp"

namespace calvin::rig {

// A pose that a view allows, and the labels that go with it.
struct BoardPose {
  SE3 camera_from_board;
  SE3 board_from_own;  // of the labels of the board and of the view
};

// What one view says of the loop.
struct Sighting {
  std::vector<BoardPose> poses;  // the best tilt by its own labels first
  std::size_t tilts = 0;         // so many of the poses come first and have the view's own labels
  SE3 base_from_hand;            // as the robot told it
};

[[nodiscard]] Sighting sighting_of(const BoardView& view, const SE3& base_from_hand);

struct HandEyeStart {
  HandEyePlaces places;
  std::vector<std::size_t> poses;  // of each sighting, the one that agrees best
  double turn = 0;                 // rad, m: medians of what is left of the loops
  double place = 0;
  bool is_decided = true;  // else other places agree with the sightings as well
};

// By all of two sightings or more. With `free_scale` the lengths of board and robot may have
// different units. Absent where the hand has not turned.
[[nodiscard]] std::optional<HandEyeStart> find_start(const std::vector<Sighting>& sightings,
                                                     EyeSetup setup, bool free_scale);

// How far the hand went, as the robot told it: root mean squares of the turn (rad) from the mean
// orientation and of the way (m) from the mean place, and the median distance of the boards, m.
struct HandMotion {
  double turn = 0;
  double way = 0;
  double distance = 0;
};
[[nodiscard]] HandMotion motion_of(const std::vector<Sighting>& sightings);

}  // namespace calvin::rig
