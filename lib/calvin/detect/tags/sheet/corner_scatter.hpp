// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the corners of a sheet tell of each other: how far light reaches over the sides of all tags,
// which corners are off, and how large errors are beside sigmas.
#pragma once

#include <optional>
#include <vector>

#include "calvin/detect/maps/lens_map.hpp"
#include "calvin/detect/tags/point.hpp"

namespace calvin::detect {

// A corner of a sheet.
struct SheetCorner {
  Pixel plane;           // in the board frame, in sides of a tag
  Pixel image;           // px
  double sigma = 0;      // px
  Point outwards;        // how it moves where the sides of its tag move outwards by 1 px
  Point outwards_plane;  // and where they do so on the board, for 1 px in the middle of the sheet
  bool is_off = false;   // something covers it
};

struct CornerScatter {
  std::vector<Point> growth;  // px, of each corner, that over-exposure or ink added to its place
  double factor = 1;          // errors beside sigmas
};

// Of corners that are known to a px or so, with the map of the sheet; marks those that are off.
// Over-exposure moves sides by the same in the picture, ink that has run on the board: what the
// corners show more of is taken. `most`: px, of the growth. Absent for too few corners.
[[nodiscard]] std::optional<CornerScatter> corner_scatter(std::vector<SheetCorner>& corners,
                                                          const LensMap& map, double most);

}  // namespace calvin::detect
