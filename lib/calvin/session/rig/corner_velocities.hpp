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

}  // namespace calvin
