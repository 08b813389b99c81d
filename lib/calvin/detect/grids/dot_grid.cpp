// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// All discs of an image, those that lie in the largest lattice, and their fits.

#include "calvin/detect/grids/dot_grid.hpp"

#include <vector>

#include "calvin/detect/circles/disc_search.hpp"
#include "calvin/detect/circles/disc_sheet.hpp"
#include "calvin/detect/grids/grid_lattice.hpp"

namespace calvin::detect {

Observation find_dot_grid(Pyramid& pyramid, const CirclePattern& pattern,
                          const std::stop_token& stop) {
  constexpr std::size_t kMostPoints = 40000;  // of a level
  DiscSearch search(kMostPoints);
  std::vector<Ellipse> discs;
  for (int level = pyramid.levels() - 1; level >= 0 && !stop.stop_requested(); --level) {
    search.add(pyramid, level, pattern.is_light(), discs);
  }
  const auto lattice = grid_lattice(discs, stop);
  if (!lattice) return {};
  const ImageView& image = pyramid.level(0);
  DiscSheet sheet;
  if (!sheet.fit(image, *lattice, kFewestGridPoints, {}) || !sheet.are_round(image)) return {};
  for (int i = 0; i < kGridReach && !stop.stop_requested() && sheet.grow(image); ++i) {
  }
  if (stop.stop_requested()) return {};
  return sheet.observe(image, pattern, CellMap{});
}

}  // namespace calvin::detect
