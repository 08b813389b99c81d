// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the corners of a board move from frame to frame. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"

namespace calvin {

// How the corners that two observations share have moved, px.
struct CornerMotion {
  std::size_t shared = 0;
  double all = 0;           // RMS distance, less the noise of the corners
  double center = 0;        // distance of the centres
  double about_center = 0;  // mean distance about the centres
};
[[nodiscard]] CornerMotion corner_motion(const Observation& from, const Observation& to);

// Whether two observations are of one picture, or of copies of it, as of a camera that repeats
// frames: noise, which is another one in each picture, is the same in both. Of a picture without
// noise, or whose corners have no sigmas, only an equal one is.
[[nodiscard]] bool shows_same_picture(const Observation& a, const Observation& b);

// s; 0 where it is not known.
[[nodiscard]] double seconds_between(const Observation& from, const Observation& to);

// The velocities of the corners of a newest observation, as Observation::velocity has them.
struct CornerVelocities {
  std::vector<Pixel> of;  // px/s
  double sigma = 0;       // px/s, 1 sigma of each coordinate by the noise of the corners
  Pixel change;           // px/s, of the velocity from step to step, the mean over the corners
};

// From the corners that three frames share: a parabola in time through each, whose slope at the end
// a polynomial over the picture smooths. Absent where the frames share too few corners, where their
// times are not known, and where the two steps contradict each other, as of pictures that are no
// video.
[[nodiscard]] std::optional<CornerVelocities> corner_velocities(const Observation& earlier,
                                                                const Observation& before,
                                                                const Observation& now);

// What is known of how evenly a board moves.
struct SteadyMotion {
  Pixel change;  // CornerVelocities::change
  double uneven =
      0;  // px/s, what the velocities may be wrong by for it, 1 sigma of each coordinate
};

// By how much a parabola misses a velocity, px/s, as the change before tells; with none before, as
// if the board had moved evenly then.
[[nodiscard]] double uneven_motion(const CornerVelocities& now,
                                   const std::optional<SteadyMotion>& before);

// Whether the corners move by more than what their velocities may be wrong by.
[[nodiscard]] bool is_significant(const CornerVelocities& velocities);

// What velocities that are wrong by `sigma` px/s leave of a corner at row v where a frame of
// `height` rows is read in `readout` s, px.
[[nodiscard]] double left_of_motion(double sigma, double readout, double v, int height);

}  // namespace calvin
