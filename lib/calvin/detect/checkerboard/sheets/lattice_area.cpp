// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a lattice lies in the image, to tell lattices of one board from those of another.

#include "calvin/detect/checkerboard/sheets/lattice_area.hpp"

#include <algorithm>
#include <cmath>

namespace calvin::detect {

LatticeArea::LatticeArea(const Lattice& lattice, int level) {
  lattice.for_each([&](Cell /*cell*/, const Node& node) {
    box.add(Pyramid::to_image(node.x, level), Pyramid::to_image(node.y, level));
  });
  const auto nodes = static_cast<float>(std::max(lattice.count(), 1));
  square = std::sqrt((box.right - box.left) * (box.bottom - box.top) / nodes);
}

bool LatticeArea::meets(const Box& other) const {
  return box.left <= other.right && other.left <= box.right && box.top <= other.bottom &&
         other.top <= box.bottom;
}

bool LatticeArea::has_middle_of(const LatticeArea& other) const {
  const float u = 0.5F * (other.box.left + other.box.right);
  const float v = 0.5F * (other.box.top + other.box.bottom);
  return u >= box.left && u <= box.right && v >= box.top && v <= box.bottom;
}

bool LatticeArea::has(const LatticeArea& other) const {
  constexpr float kLike = 1.7F;  // ratio of the squares' sides
  return has_middle_of(other) && other.square < kLike * square && square < kLike * other.square;
}

}  // namespace calvin::detect
