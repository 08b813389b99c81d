// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the cameras of a simulated rig see, for the tests of elements: apart from these, as the
// library's check() and their namespace of that name exclude each other.
#pragma once

#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin::rig_views {

struct SeenByCamera {
  Calibration calibration;
  SE3 world_from_camera;
  std::vector<Observation> observations;
};

// Two cameras side by side, or four of different lenses and sizes in a ring.
[[nodiscard]] std::vector<SeenByCamera> stereo();
[[nodiscard]] std::vector<SeenByCamera> ring();

// A board that swings before the first two, 30 times in a second for so many seconds; the clock of
// the second one is `behind` s behind.
[[nodiscard]] std::vector<SeenByCamera> swinging(int seconds, double behind);

// Two cameras that look at each other, and a box with a board on each side between them.
[[nodiscard]] std::vector<SeenByCamera> before_a_box();

// Four cameras around a room, and a light that is elsewhere in each picture.
[[nodiscard]] std::vector<SeenByCamera> lit_room(int instants);
// The same with a wand, wand:150mm+350mm.
[[nodiscard]] std::vector<SeenByCamera> lit_room_of_wand(int instants);

// The largest component of how far the cameras of a rig are from where they stand, in sigmas: to
// the first one, or in the frame of known places.
[[nodiscard]] double worst_error(const Rig& rig, const std::vector<SeenByCamera>& truth);

}  // namespace calvin::rig_views
