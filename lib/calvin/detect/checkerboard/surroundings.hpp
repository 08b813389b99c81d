// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far it is from the corners of a board to the next lines of corners, and to what else is
// printed around them.
#pragma once

#include <algorithm>
#include <limits>

namespace calvin::detect {

// `along` and `aside` are shares of the distance to the nearest next line.
struct Surroundings {
  // Of every two steps from a line of corners to the next the shorter one, in parts of their mean.
  float gap = 1;
  float along = 1;       // from a corner along an edge, to what is printed on the edge
  float aside = 1;       // from an edge, to what is printed beside it
  bool blurred = false;  // what is printed beside edges cannot be seen, or was taken out

  // Where squares have sides of `spacing` px: how far from a corner its edges are clear, as the
  // distance to the next edge is for a board without anything on them.
  [[nodiscard]] float clear(float spacing) const {
    constexpr float kOfWindow = 0.6F;  // of what is clear, the radius of the largest window
    return std::min(1.0F, along / kOfWindow) * spacing;
  }

  // How far from an edge the pixels tell about it and about nothing else, px; `width` is that of
  // the edges' blur, of which what is printed beside them has as much. Where that leaves less than
  // the edge itself takes, a little of the next one is in them.
  [[nodiscard]] float room(float spacing, float width) const {
    constexpr float kLeast = 1.5F;    // px
    constexpr float kClear = 2.5F;    // edge widths before the next edge
    constexpr float kBlurred = 0.5F;  // edge widths beyond the next edge
    if (blurred) return aside * spacing + kBlurred * width;
    if (aside >= 1) return std::numeric_limits<float>::infinity();
    const float next = aside * spacing;
    return std::max({kLeast, next - kClear * width, std::min(next - width, width)});
  }

  // Whether markers beside the edges can be seen.
  [[nodiscard]] bool has_markers() const { return aside < 1 && !blurred; }

  // How many times longer the longer step is than the shorter one.
  [[nodiscard]] float step_ratio() const { return (2 - gap) / gap; }

  // Of any of two boards.
  [[nodiscard]] Surroundings with(const Surroundings& other) const {
    return {std::min(gap, other.gap), std::min(along, other.along), std::min(aside, other.aside),
            blurred || other.blurred};
  }
};

}  // namespace calvin::detect
