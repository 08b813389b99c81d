// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What all parts of the overlay are made with.

#include "calvin/draw/overlay_shapes.hpp"

#include <algorithm>

namespace calvin {

double unit_of(ImageSize frame) noexcept {
  return std::max(0.5, std::min(frame.width, frame.height) / 480.0);
}

void add_box(std::vector<Shape>& shapes, double x, double y, double width, double height,
             const Colour& colour) {
  // Boxes are given by their edges; a pixel's edge lies half a pixel from its centre.
  shapes.push_back({Shape::Kind::kBox,
                    {x - 0.5, y - 0.5},
                    {x + width - 0.5, y + height - 0.5},
                    0,
                    0,
                    colour,
                    0});
}

}  // namespace calvin
