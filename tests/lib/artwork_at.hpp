// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The colour of an artwork at a place, by looking at all of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calvin/target/artwork/artwork.hpp"

namespace calvin::scenes {

inline bool is_dark_at(const Artwork& artwork, double x, double y) {
  for (auto disc = artwork.discs.rbegin(); disc != artwork.discs.rend(); ++disc) {
    if (std::hypot(x - disc->x, y - disc->y) < disc->diameter / 2) return disc->is_dark;
  }
  const auto cell_of = [](const std::vector<double>& cuts, double at) {
    return static_cast<int>(
               std::count_if(cuts.begin(), cuts.end(), [at](double cut) { return cut <= at; })) -
           1;
  };
  const int col = cell_of(artwork.x, x);
  const int row = cell_of(artwork.y, y);
  return col >= 0 && row >= 0 && col < artwork.cols() && row < artwork.rows() &&
         artwork.is_dark(col, row);
}

}  // namespace calvin::scenes
