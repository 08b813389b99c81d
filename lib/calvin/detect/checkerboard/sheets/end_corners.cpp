// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Places by the map of the whole board, and the tests of what is there.

#include "calvin/detect/checkerboard/sheets/end_corners.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "calvin/detect/checkerboard/fits/guesses.hpp"
#include "calvin/detect/maps/lens_map.hpp"

namespace calvin::detect {

namespace {

constexpr int kFewestOfMap = 12;  // nodes: the map of fewer leads beyond them anywhere
constexpr float kOffMap = 0.1F;   // of the spacing, from where the map has a corner

// A corner that the lattice has not, and the way to two of its line that it has.
struct EndCorner {
  Cell cell;
  Cell step;
  Expected expected;
};

std::optional<LensMap> map_of(const ImageView& image, const Lattice& lattice) {
  if (lattice.count() < kFewestOfMap) return std::nullopt;
  std::vector<Pixel> places;
  std::vector<Pixel> nodes;
  lattice.for_each([&](Cell c, const Node& node) {
    const LatticePlace at = lattice.place(c);
    places.push_back({at.col, at.row});
    nodes.push_back({static_cast<double>(node.x), static_cast<double>(node.y)});
  });
  return LensMap::fit(places, nodes, image_center(image.size()), 0, 0);
}

bool is_inside(const ImageView& image, const Expected& at) {
  return at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(image.width - 1) &&
         at.y <= static_cast<float>(image.height - 1);
}

// Where the map has a corner, as far as it has the one beside it where that is: what two or three
// corners of a line let expect is too far off before a wide lens.
void expect_by_map(const LensMap& map, const Lattice& lattice, EndCorner& corner) {
  const auto image_of = [&](Cell c) {
    const LatticePlace at = lattice.place(c);
    return map.image_of({at.col, at.row});
  };
  const Pixel here = image_of(corner.cell);
  const Pixel near = image_of(corner.cell + corner.step);
  const Node& node = lattice.at(corner.cell + corner.step);
  corner.expected.x = node.x + static_cast<float>(here.u - near.u);
  corner.expected.y = node.y + static_cast<float>(here.v - near.v);
}

std::vector<EndCorner> end_corners(const Grid& grid, const GridAlignment& alignment,
                                   const Lattice& lattice) {
  std::vector<EndCorner> corners;
  for (const int id : grid.ids()) {
    const GridPlace at = grid.place(id);
    const Cell c = alignment.cell({at.col, at.row});
    if (lattice.has(c)) continue;
    for (const Cell step : kAround) {
      if (!lattice.has(c + step) || !lattice.has(c + 2 * step)) continue;
      if (const auto expected = lattice.expect(c)) corners.push_back({c, step, *expected});
      break;
    }
  }
  return corners;
}

bool add(const ImageView& image, const EndCorner& corner, Refinement& refinement,
         Lattice& lattice) {
  const Cell near = corner.cell + corner.step;
  Node node = lattice.at(near);
  node.x = corner.expected.x;
  node.y = corner.expected.y;
  lattice.put(corner.cell, node);
  if (confirm_guess(image, lattice, corner.cell, lattice.at(corner.cell)) &&
      refinement.add(image, lattice, corner.cell, near)) {
    const SaddleFit& fit = refinement.at(corner.cell);
    if (distance(fit, node) <= kOffMap * corner.expected.spacing) {
      take(fit, lattice.at(corner.cell));
      return true;
    }
  }
  lattice.remove(corner.cell);
  return false;
}

}  // namespace

void add_end_corners(const ImageView& image, const Grid& grid, const GridAlignment& alignment,
                     Refinement& refinement, Lattice& lattice) {
  if (refinement.in_noise()) return;
  std::vector<Cell> added;
  std::optional<LensMap> map;
  for (bool again = true; again;) {
    again = false;
    for (EndCorner& corner : end_corners(grid, alignment, lattice)) {
      if (!map) map = map_of(image, lattice);
      if (map) expect_by_map(*map, lattice, corner);
      if (!is_inside(image, corner.expected)) continue;
      if (!add(image, corner, refinement, lattice)) continue;
      added.push_back(corner.cell);
      again = true;
    }
  }
  if (added.empty() || refinement.refine_added(image, added, lattice)) return;
  for (const Cell c : added) lattice.remove(c);
}

}  // namespace calvin::detect
