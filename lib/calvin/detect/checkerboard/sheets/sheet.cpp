// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What belongs to a sheet: the corners within its outline and those on its grid.

#include "calvin/detect/checkerboard/sheets/sheet.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/pyramid.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/homography.hpp"
#include "calvin/geometry/pixels.hpp"

namespace calvin::detect {

namespace {

constexpr double kMostWithin = 0.25;  // of the nodes of another sheet, within the outline of one

Pixel in_image(const Node& node, int level) {
  return {static_cast<double>(Pyramid::to_image(node.x, level)),
          static_cast<double>(Pyramid::to_image(node.y, level))};
}

// How far a place is from the next line of a lattice, in mean steps.
double off_lines(const Lattice& lattice, double place, bool is_col) {
  const int even = 2 * static_cast<int>(std::floor(place / 2));
  double least = 1;
  for (int line = even; line <= even + 2; ++line) {
    least = std::min(least, std::abs(static_cast<double>(lattice.place(line, is_col)) - place));
  }
  return least;
}

// Whether most nodes lie where the rows and columns of the sheet's own nodes would go on, no
// further off than the board is long.
bool goes_on_with(const Sheet& sheet, const Lattice& lattice, int level) {
  constexpr double kOff = 0.2;  // of the shorter step
  constexpr double kMostOnGrid = 0.8;
  const double most = kOff * static_cast<double>(sheet.lattice.surroundings().gap);
  std::vector<Pixel> cells;
  std::vector<Pixel> places;
  sheet.lattice.for_each([&](Cell c, const Node& node) {
    const LatticePlace at = sheet.lattice.place(c);
    cells.push_back({at.col, at.row});
    places.push_back(in_image(node, 0));
  });
  const auto to_cell = fit_homography(places, cells);
  if (!to_cell) return false;
  const double reach = std::max(sheet.alignment.cols, sheet.alignment.rows);
  const Cell first = sheet.alignment.origin;
  int on_grid = 0;
  lattice.for_each([&](Cell /*cell*/, const Node& node) {
    const Pixel at = transform(*to_cell, in_image(node, level));
    const bool near =
        std::abs(at.u - first.col) < 2 * reach && std::abs(at.v - first.row) < 2 * reach;
    const bool is_on_grid =
        off_lines(sheet.lattice, at.u, true) < most && off_lines(sheet.lattice, at.v, false) < most;
    on_grid += near && is_on_grid ? 1 : 0;
  });
  return on_grid > kMostOnGrid * lattice.count();
}

}  // namespace

Pixel Sheet::center() const { return mean_of(observation.uv); }

std::vector<Pixel> outline_of(const Observation& corners, const Grid& grid) {
  constexpr double kMargin = 0.6;  // of the shorter step
  const double step = grid.mean_step();
  const double margin = kMargin * grid.gap_share();
  std::vector<Pixel> cells;
  cells.reserve(corners.ids.size());
  for (const int id : corners.ids) {
    const GridPlace place = grid.place(id);
    cells.push_back({grid.distance_to(place.col) / step, grid.distance_to(place.row) / step});
  }
  const auto to_image = fit_homography(cells, corners.uv);
  if (!to_image) return convex_hull(corners.uv);
  // The outermost corners move outwards by the margin, those between them by a part of it: by what
  // that is in the image, where the lens may bend the rows.
  const auto [left, right] = std::ranges::minmax(cells, {}, &Pixel::u);
  const auto [top, bottom] = std::ranges::minmax(cells, {}, &Pixel::v);
  std::vector<Pixel> grown;
  grown.reserve(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Pixel& cell = cells[i];
    const Pixel outwards = {
        cell.u + margin * (2 * cell.u - left.u - right.u) / std::max(right.u - left.u, 1.0),
        cell.v + margin * (2 * cell.v - top.v - bottom.v) / std::max(bottom.v - top.v, 1.0)};
    const Pixel from = transform(*to_image, cell);
    const Pixel to = transform(*to_image, outwards);
    const Pixel moved = {corners.uv[i].u + to.u - from.u, corners.uv[i].v + to.v - from.v};
    grown.push_back(std::isfinite(moved.u) && std::isfinite(moved.v) ? moved : corners.uv[i]);
  }
  return convex_hull(std::move(grown));
}

std::vector<Pixel> in_level(const std::vector<Pixel>& outline, int level) {
  std::vector<Pixel> scaled = outline;
  for (Pixel& p : scaled) p = {Pyramid::to_level(p.u, level), Pyramid::to_level(p.v, level)};
  return scaled;
}

bool is_of_sheet(const Sheet& sheet, const Lattice& lattice, int level) {
  int within = 0;
  lattice.for_each([&](Cell /*cell*/, const Node& node) {
    within += contains(sheet.outline, in_image(node, level)) ? 1 : 0;
  });
  return within > kMostWithin * lattice.count() ||
         (!sheet.whole && goes_on_with(sheet, lattice, level));
}

}  // namespace calvin::detect
