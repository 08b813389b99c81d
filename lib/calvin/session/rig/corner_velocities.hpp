// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How fast corners move, by two pictures of one camera.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"

namespace calvin {

// How fast each corner of `now` moves on its way from another observation, or to it, px/s: that of
// the middle of the way. Corners that the other one has not move as the others do on average; empty
// where it has none. Ids ascend.
[[nodiscard]] std::vector<Pixel> velocities(const Observation& now, const Observation& other);

// Of two lists that is `share` of the way from the first to the second.
[[nodiscard]] std::vector<Pixel> interpolated(const std::vector<Pixel>& first,
                                              const std::vector<Pixel>& second, double share);

// Whether nobody knows how a board moves at a picture, by the velocities on its way there and on
// its way from there: it goes over `far` px on one of them, at least, and has hardly anything of
// that velocity on the other one, as where it is put down, or in stills that are shown as a video.
[[nodiscard]] bool is_jump(const std::vector<Pixel>& there, double seconds_there,
                           const std::vector<Pixel>& from_there, double seconds_from_there,
                           double far);

// RMS, px/s.
[[nodiscard]] double speed_of(const std::vector<Pixel>& velocities);

}  // namespace calvin
