// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The few shapes that an overlay is made of. Private to draw/.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/draw/overlay.hpp"

namespace calvin {

struct Colour {
  double red = 0;
  double green = 0;
  double blue = 0;
  double alpha = 1;

  [[nodiscard]] bool operator==(const Colour&) const = default;
};

// Positions in px of the frame, the centre of the first pixel at (0, 0).
struct Shape {
  enum class Kind { kLine, kCircle, kDisc, kBox };
  Kind kind = Kind::kLine;
  Pixel from;         // an end, the centre, a corner
  Pixel to;           // the other end or corner
  double radius = 0;  // of a circle or disc, px
  double width = 0;   // of the pen, px
  Colour colour;
  double halo = 0;     // px of dark around it, so that it shows on any ground; a box has none
  bool moves = false;  // with the board: what does not is kept from frame to frame

  [[nodiscard]] bool operator==(const Shape& o) const {
    return kind == o.kind && from.u == o.from.u && from.v == o.from.v && to.u == o.to.u &&
           to.v == o.to.v && radius == o.radius && width == o.width && colour == o.colour &&
           halo == o.halo && moves == o.moves;
  }
};

inline constexpr Colour kWhite{1, 1, 1, 1};
inline constexpr Colour kGreen{0.2, 0.9, 0.35, 1};
inline constexpr Colour kPanel{0, 0, 0, 0.5};
inline constexpr Colour kTrack{1, 1, 1, 0.25};

// The size of everything: 1 px of a frame 480 px high.
[[nodiscard]] double unit_of(ImageSize frame) noexcept;

void add_box(std::vector<Shape>& shapes, double x, double y, double width, double height,
             const Colour& colour);

// Bars, chips and the map of what boards covered, in an upper corner.
void add_panel(std::vector<Shape>& shapes, ImageSize frame, const Progress& progress,
               const OverlayParts& parts);

// A cross at each manual point, the newest one in green.
void add_points(std::vector<Shape>& shapes, ImageSize frame, const Progress& progress);

struct Extent {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;
};

// The pixels that a shape can touch.
[[nodiscard]] Extent extent_of(const Shape& shape) noexcept;

}  // namespace calvin
