// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the corners of a square, and how the lines bend that they are on.

#include "calvin/detect/checkerboard/code/lattice_square.hpp"

#include <algorithm>
#include <cstddef>

namespace calvin::detect {

namespace {

// How the places of a line bend from a node to the next, px: the second derivative by the step
// between them. The mean of the parabolas about both nodes; 0 where the line is too short.
Direction bend_between(const Lattice& lattice, Cell from, Cell step) {
  Direction sum = {0, 0};
  float count = 0;
  const float length = lattice.length(from, step);
  for (const Cell c : {from, from + step}) {
    if (!lattice.has(c - step) || !lattice.has(c + step)) continue;
    const Node& before = lattice.at(c - step);
    const Node& here = lattice.at(c);
    const Node& after = lattice.at(c + step);
    const float behind = lattice.length(c - step, step);
    const float ahead = lattice.length(c, step);
    const auto second = [&](float Node::*of) {
      const float change = (after.*of - here.*of) / ahead - (here.*of - before.*of) / behind;
      return 2 * change / (ahead + behind) * length * length;
    };
    sum.x += second(&Node::x);
    sum.y += second(&Node::y);
    count += 1;
  }
  return count > 0 ? Direction{sum.x / count, sum.y / count} : sum;
}

}  // namespace

std::optional<LatticeSquare> LatticeSquare::at(const Lattice& lattice, Cell cell) {
  LatticeSquare square;
  int known = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Cell c = cell + Cell{static_cast<int>(i % 2), static_cast<int>(i / 2)};
    if (lattice.has(c)) {
      square.corners_[i] = {lattice.at(c).x, lattice.at(c).y};
      square.contrast_ = std::max(square.contrast_, lattice.at(c).contrast);
      ++known;
      continue;
    }
    const auto expected = lattice.in_reach(c) ? lattice.expect(c) : std::nullopt;
    if (!expected) return std::nullopt;
    square.corners_[i] = {expected->x, expected->y};
  }
  if (known < 2) return std::nullopt;
  // What is expected of a corner is too far off for that.
  for (std::size_t i = 0; i < 2 && known == 4; ++i) {
    const int far = static_cast<int>(i);
    square.along_bend_[i] = bend_between(lattice, cell + Cell{0, far}, {1, 0});
    square.down_bend_[i] = bend_between(lattice, cell + Cell{far, 0}, {0, 1});
  }
  return square;
}

}  // namespace calvin::detect
