// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Points of a grid that a search has given the wrong numbers.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::detect {

// Which points of a grid, of which the next ones are 1 apart in the plane, are elsewhere than the
// map of the others has them: by more than `most` of the distance to the next one, or half of that
// where the map explains the others well. The map is that of the points that it explains best.
[[nodiscard]] std::vector<std::size_t> grid_outliers(std::span<const Pixel> plane,
                                                     std::span<const Pixel> image,
                                                     const Pixel& middle, double most);

}  // namespace calvin::detect
