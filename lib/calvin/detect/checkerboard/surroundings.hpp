// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What else a board has around its corners than the edges of its squares.
#pragma once

#include <algorithm>
#include <limits>

namespace calvin::detect {

// Shares of a square's side.
struct Surroundings {
  float along = 1;  // from a corner along an edge, to what is printed on the edge
  float aside = 1;  // from an edge, to what is printed beside it

  // Where squares have sides of `spacing` px: how far from a corner its edges are clear, as the
  // distance to the next edge is for a board without anything on them.
  [[nodiscard]] float clear(float spacing) const {
    constexpr float kOfWindow = 0.6F;  // of what is clear, the radius of the largest window
    return std::min(1.0F, along / kOfWindow) * spacing;
  }

  // How far from an edge, px, nothing else is in the picture; `width` is that of the edges' blur.
  [[nodiscard]] float room(float spacing, float width) const {
    constexpr float kLeast = 1.5F;  // px
    if (aside >= 1) return std::numeric_limits<float>::infinity();
    return std::max(kLeast, aside * spacing - width);
  }

  // Of any of two boards.
  [[nodiscard]] Surroundings with(const Surroundings& other) const {
    return {std::min(along, other.along), std::min(aside, other.aside)};
  }
};

}  // namespace calvin::detect
