// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Points and quads of an image.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "calvin/core/image.hpp"

namespace calvin::detect {

using Point = Eigen::Vector2d;  // px

[[nodiscard]] inline bool is_in(const ImageView& image, const Point& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() <= image.width - 1 && p.y() <= image.height - 1;
}

[[nodiscard]] inline Pixel pixel_of(const Point& p) { return {p.x(), p.y()}; }
[[nodiscard]] inline Point point_of(const Pixel& p) { return {p.u, p.v}; }

// Four corners, clockwise as they are seen.
using Quad = std::array<Point, 4>;

[[nodiscard]] inline double cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

[[nodiscard]] inline Point centre_of(const Quad& quad) {
  return (quad[0] + quad[1] + quad[2] + quad[3]) / 4;
}

// px, of its four sides.
[[nodiscard]] inline double shortest_side(const Quad& quad) {
  double shortest = (quad[3] - quad[0]).norm();
  for (std::size_t i = 0; i < 3; ++i) {
    shortest = std::min(shortest, (quad[i + 1] - quad[i]).norm());
  }
  return shortest;
}

// Whether all corners turn the same way, clockwise.
[[nodiscard]] inline bool is_convex(const Quad& quad) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Point before = quad[(i + 1) % 4] - quad[i];
    const Point after = quad[(i + 2) % 4] - quad[(i + 1) % 4];
    if (!(cross(before, after) > 0)) return false;
  }
  return true;
}

}  // namespace calvin::detect
