// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is printed in a tag and around it. Places are in cells from the upper left corner of a tag.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "calvin/detect/tags/point.hpp"
#include "calvin/target/marker_dictionary.hpp"

namespace calvin::detect {

struct TagPattern {
  const MarkerDictionary* dictionary = nullptr;
  int side = 0;            // bits
  int border = 1;          // cells
  double gap = 0;          // cells, around the tag: up to bits outside of it, or to another tag
  bool inverted = false;   // the border is light
  std::uint64_t bits = 0;  // as in the dictionary, the tag being the right way up
  // Whether another tag begins behind the gap at each side, from the upper one on clockwise.
  std::array<bool, 4> neighbours{};

  [[nodiscard]] int cells() const noexcept { return side + 2 * border; }
  // Whether a cell is like what is around the border: light where the border is dark. The ring
  // inside of outer bits is, and so is the free middle of some tags; paper is like the border then.
  [[nodiscard]] bool is_light(int col, int row) const noexcept {
    const int bit = dictionary->bit_at(col - border, row - border);
    if (bit >= 0) {
      return ((bits >> (dictionary->bit_count() - 1 - bit) & 1) != 0) !=
             dictionary->has_light_rim();
    }
    const int last = cells() - 1;
    const int depth = std::min({col, row, last - col, last - row});
    return dictionary->has_light_rim() && depth >= -1 && (depth < 0 || depth >= border);
  }
  // Cells outside of the border that belong to the tag.
  [[nodiscard]] int outside() const noexcept { return dictionary->outside; }
  // The place so many cells along a side, clockwise, and so many inwards.
  [[nodiscard]] Point place(std::size_t of_side, double along, double inwards) const {
    const double n = cells();
    switch (of_side) {
      case 0:
        return {along, inwards};
      case 1:
        return {n - inwards, along};
      case 2:
        return {n - along, n - inwards};
      default:
        return {inwards, n - along};
    }
  }
};

// The homography from cells to the image that takes the corners (0, 0), (n, 0), (n, n), (0, n) to
// those of a quad: P. Heckbert, Fundamentals of Texture Mapping, 1989, section 2.2.3.
[[nodiscard]] inline Eigen::Matrix3d from_cells(const Quad& quad, double n) {
  const Point d1 = quad[1] - quad[2];
  const Point d2 = quad[3] - quad[2];
  const Point d3 = quad[0] - quad[1] + quad[2] - quad[3];
  const double turn = cross(d1, d2);
  const double g = cross(d3, d2) / turn;
  const double h = cross(d1, d3) / turn;
  const Point x = quad[1] - quad[0] + g * quad[1];
  const Point y = quad[3] - quad[0] + h * quad[3];
  Eigen::Matrix3d m;
  m << x.x() / n, y.x() / n, quad[0].x(), x.y() / n, y.y() / n, quad[0].y(), g / n, h / n, 1;
  return m;
}

}  // namespace calvin::detect
