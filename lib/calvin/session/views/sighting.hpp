// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A sheet from frame to frame: how it moves, and a view of it while it does.
#pragma once

#include <optional>

#include "calvin/core/observation.hpp"
#include "calvin/session/views/corner_motion.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

// s, between frames: over a longer time no hand moves evenly, and two stills tell nothing of what
// a board did while one was read.
inline constexpr double kFarApart = 0.12;
inline constexpr double kSameSheet = 0.5;  // of the board's size in the image, between two frames

// An observation, and that of the same sheet in the frame before.
struct Sighting {
  Observation seen;
  std::optional<Observation> before;
  std::optional<SteadyMotion> motion;
};

// The velocities of the corners of a sheet that was seen a frame before. Joins `now` to it.
[[nodiscard]] std::optional<CornerVelocities> velocities_of(Sighting& now, const Sighting& before);

// What velocities that are wrong by `sigma` px/s leave of the motion in a frame that is read for
// `readout` s: px, RMS over the corners.
[[nodiscard]] double left_of_motion(const Observation& seen, double sigma, double readout);

// The view with the velocities of its corners. What these may be wrong by in a frame that is read
// for `readout` s is in its sigmas.
[[nodiscard]] View moving(View view, const CornerVelocities& velocities, double readout);

}  // namespace calvin
