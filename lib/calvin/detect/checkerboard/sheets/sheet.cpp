// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What belongs to a sheet: the corners within its outline and those on its grid.

#include "calvin/detect/checkerboard/sheets/sheet.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/pyramid.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/homography.hpp"

namespace calvin::detect {

namespace {

constexpr double kMostWithin = 0.25;  // of the nodes of another sheet, within the outline of one

Pixel mean_of(const std::vector<Pixel>& points) {
  Pixel mean;
  for (const Pixel& p : points) {
    mean.u += p.u / static_cast<double>(points.size());
    mean.v += p.v / static_cast<double>(points.size());
  }
  return mean;
}

Pixel in_image(const Node& node, int level) {
  return {static_cast<double>(Pyramid::to_image(node.x, level)),
          static_cast<double>(Pyramid::to_image(node.y, level))};
}

// Whether most nodes lie where the rows and columns of the sheet's own nodes would go on, no
// further off than the board is long.
bool goes_on_with(const Sheet& sheet, const Lattice& lattice, int level) {
  constexpr double kOff = 0.2;  // squares
  constexpr double kMost = 0.8;
  std::vector<Pixel> cells;
  std::vector<Pixel> places;
  sheet.lattice.for_each([&](Cell c, const Node& node) {
    cells.push_back({static_cast<double>(c.col), static_cast<double>(c.row)});
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
    on_grid +=
        near && std::abs(at.u - std::round(at.u)) < kOff && std::abs(at.v - std::round(at.v)) < kOff
            ? 1
            : 0;
  });
  return on_grid > kMost * lattice.count();
}

}  // namespace

Pixel Sheet::center() const { return mean_of(observation.uv); }

std::vector<Pixel> outline_of(const Observation& corners, const Checkerboard& board) {
  constexpr double kMargin = 0.6;  // squares
  const Pixel middle = mean_of(corners.uv);
  const double grown = 1 + 2 * kMargin / (std::min(board.cols, board.rows) - 1);
  std::vector<Pixel> outline = convex_hull(corners.uv);
  for (Pixel& p : outline) {
    p = {middle.u + grown * (p.u - middle.u), middle.v + grown * (p.v - middle.v)};
  }
  return outline;
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
