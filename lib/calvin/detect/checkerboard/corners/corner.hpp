// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether four squares meet at a point of the image, and how they lie.
#pragma once

#include "calvin/core/image.hpp"

namespace calvin::detect {

// A direction in the image, of unit length.
struct Direction {
  float x = 1;
  float y = 0;
};
[[nodiscard]] inline float dot(Direction a, Direction b) { return a.x * b.x + a.y * b.y; }
[[nodiscard]] inline float cross(Direction a, Direction b) { return a.x * b.y - a.y * b.x; }
[[nodiscard]] inline Direction operator-(Direction a) { return {-a.x, -a.y}; }

// A point at which two straight edges cross. Going from +x to +y, the image gets brighter behind
// `rising` and darker behind `falling`: between the two it is bright. cross(rising, falling) > 0.
// On a checkerboard the two swap places from a corner to the next.
struct Corner {
  float x = 0;
  float y = 0;
  Direction rising;
  Direction falling;
  float contrast = 0;  // grey levels between the darkest and the brightest around it
};

enum class RingSize { kSmall, kLarge };
inline constexpr int kRingReach = 5;  // px, of the larger ring

// Looks at a ring of pixels around (x, y), at least kRingReach from the border: a corner has
// exactly four changes of colour on it, in opposite pairs, and looks the same turned by 180
// degrees: `asymmetry` is how much opposite samples may differ, 0 to 1. Sets everything of `corner`
// but its place.
[[nodiscard]] bool check_ring(const ImageView& image, int x, int y, RingSize size, float asymmetry,
                              Corner& corner) noexcept;

}  // namespace calvin::detect
