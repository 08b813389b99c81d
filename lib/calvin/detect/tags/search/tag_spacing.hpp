// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far the tags of a grid that nobody asked for lie apart.
#pragma once

#include <span>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/target/april_grid.hpp"
#include "calvin/target/grid.hpp"

namespace calvin::detect {

// A corner of a tag in a grid.
struct TagCorner {
  GridPlace tag;
  int right = 0;  // 1 for a corner at the right of its tag
  int below = 0;
  Pixel at;
};

// The distance from one tag to the next, in sides of a tag, for which all corners fit best, as a
// lens makes it seem larger here and smaller there; `guess` where that tells nothing. It goes .08
// from the guess at most.
[[nodiscard]] double fit_pitch(ImageSize size, std::span<const TagCorner> corners, double guess);

// A gap as it was meant, in sides of a tag: most are multiples of a twentieth, or as narrow as can
// be.
struct Gap {
  double share = 0;
  bool is_certain = false;
};
[[nodiscard]] Gap gap_of(double pitch, double least);

// The same grid with the gaps that its corners in a picture have.
[[nodiscard]] AprilGrid with_seen_gaps(const AprilGrid& grid, const Observation& seen);

}  // namespace calvin::detect
