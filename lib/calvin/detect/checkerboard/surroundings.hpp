// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What else a board has around its corners than the edges of its squares.
#pragma once

#include <algorithm>

namespace calvin::detect {

// Shares of a square's side.
struct Surroundings {
  float along = 1;  // from a corner along an edge, to what is printed on the edge
  float aside = 1;  // from an edge, to what is printed beside it

  // Of any of two boards.
  [[nodiscard]] Surroundings with(const Surroundings& other) const {
    return {std::min(along, other.along), std::min(aside, other.aside)};
  }
};

}  // namespace calvin::detect
