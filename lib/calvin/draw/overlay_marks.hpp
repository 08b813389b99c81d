// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Circles and discs that were drawn before. Private to draw/.
#pragma once

#include <map>
#include <tuple>

#include "calvin/draw/cairo.hpp"
#include "calvin/draw/overlay_shapes.hpp"

namespace calvin {

// A board has dozens of equal marks, and each costs Cairo as much as a long line: they are drawn
// once for each size and each quarter of a pixel that they lie at, and laid down in any colour.
class MarkMasks {
 public:
  // A circle or disc, its pen or radius larger by `grow` px on every side.
  void paint(cairo_t* cr, const Shape& shape, const Colour& colour, double grow);

 private:
  struct Mask {
    CairoSurface alpha;
    int reach = 0;  // px, from the pixel of the centre to each side
  };
  // Kind, radius, width of the pen, and where in its pixel the centre is, in parts of a px.
  using Key = std::tuple<Shape::Kind, int, int, int, int>;

  const Mask& mask_of(const Key& key);

  std::map<Key, Mask> masks_;
};

}  // namespace calvin
