// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// All discs of an image, those that lie in the largest lattice, and their fits.

#include "calvin/detect/grids/dot_grid.hpp"

#include <cmath>
#include <vector>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/detect/circles/disc_search.hpp"
#include "calvin/detect/circles/disc_sheet.hpp"
#include "calvin/detect/grids/grid_lattice.hpp"

namespace calvin::detect {

namespace {

// Whether the ground is seen half way between dots: the dark squares of a checkerboard, which lie
// on a lattice along its diagonals, meet there.
bool stand_apart(const ImageView& image, const DiscLattice& lattice) {
  constexpr double kGround = 0.75;  // of the way from the grey level of a dot to that around it
  int apart = 0;
  int pairs = 0;
  for (const Cell c : lattice.cells()) {
    for (const Cell step : {Cell{1, 0}, Cell{0, 1}}) {
      const Ellipse* next = lattice.at(c + step);
      if (next == nullptr) continue;
      const Ellipse& e = *lattice.at(c);
      const auto grey = grey_at(image, static_cast<float>((e.x + next->x) / 2),
                                static_cast<float>((e.y + next->y) / 2));
      if (!grey) continue;
      ++pairs;
      const auto share = static_cast<double>((*grey - e.inside) / (e.outside - e.inside));
      apart += share > kGround ? 1 : 0;
    }
  }
  return 2 * apart > pairs;
}

// Dots of a grid lie about in the middle between those on both sides, whatever lens or tilt bends
// their row. Spots of noise that a lattice happens to join do not.
bool are_even(const DiscLattice& lattice) {
  constexpr double kOff = 0.15;  // of the way from one neighbour to the other one, halved
  int even = 0;
  int rows = 0;
  for (const Cell c : lattice.cells()) {
    const Ellipse& e = *lattice.at(c);
    for (const Cell step : {Cell{1, 0}, Cell{0, 1}}) {
      const Ellipse* before = lattice.at(c - step);
      const Ellipse* next = lattice.at(c + step);
      if (before == nullptr || next == nullptr) continue;
      const double way = std::hypot(next->x - before->x, next->y - before->y) / 2;
      const double off =
          std::hypot((next->x + before->x) / 2 - e.x, (next->y + before->y) / 2 - e.y);
      ++rows;
      even += off < kOff * way ? 1 : 0;
    }
  }
  return 2 * even > rows;
}

}  // namespace

Observation find_dot_grid(Pyramid& pyramid, const CirclePattern& pattern,
                          const std::stop_token& stop) {
  constexpr std::size_t kMostDots = 40000;  // of a level
  DiscSearch search(kMostDots);
  std::vector<Ellipse> discs;
  for (int level = pyramid.levels() - 1; level >= 0 && !stop.stop_requested(); --level) {
    search.add(pyramid, level, pattern.is_light(), discs);
  }
  const ImageView& image = pyramid.level(0);
  const auto lattice = grid_lattice(discs, image_center(image.size()), stop);
  if (!lattice) return {};
  DiscSheet sheet;
  if (!sheet.fit(image, *lattice, kFewestGridPoints, {}) || !sheet.are_round(image) ||
      !are_even(sheet.lattice()) || !stand_apart(image, sheet.lattice())) {
    return {};
  }
  for (int i = 0; i < kGridReach && !stop.stop_requested() && sheet.grow(image); ++i) {
  }
  if (stop.stop_requested()) return {};
  return sheet.observe(image, pattern, CellMap{});
}

}  // namespace calvin::detect
