// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The mean of a board over the polygon of a pixel.

#include "calvin/synth/scene.hpp"

#include <algorithm>

#include "calvin/synth/disc_cut.hpp"

namespace calvin::synth {

namespace {

// The cuts of the sheet: those of the artwork, and its own edges.
std::vector<double> sheet_cuts(const std::vector<double>& printed, double first, double last) {
  std::vector<double> cuts;
  if (printed.empty() || first < printed.front()) cuts.push_back(first);
  cuts.insert(cuts.end(), printed.begin(), printed.end());
  if (last > cuts.back()) cuts.push_back(last);
  return cuts;
}

// Around what a pixel covers of the board plane.
BoardArea area_of(const PixelCorners& corners) {
  BoardArea area{corners[0].x / corners[0].w, corners[0].y / corners[0].w, 0, 0};
  area.right = area.left;
  area.bottom = area.top;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double x = corners[i].x / corners[i].w;
    const double y = corners[i].y / corners[i].w;
    area = {std::min(area.left, x), std::min(area.top, y), std::max(area.right, x),
            std::max(area.bottom, y)};
  }
  return area;
}

}  // namespace

Scene::Scene(const Artwork& artwork)
    : x_(sheet_cuts(artwork.x, artwork.outline.left - artwork.margin,
                    artwork.outline.right + artwork.margin)),
      y_(sheet_cuts(artwork.y, artwork.outline.top - artwork.margin,
                    artwork.outline.bottom + artwork.margin)),
      stride_(static_cast<std::size_t>(x_.count()) + 2),
      inks_(stride_ * (static_cast<std::size_t>(y_.count()) + 2), Ink::kBackground),
      discs_(artwork.discs) {
  // The margin is as wide on either side, so the printed cells lie in the middle.
  const int left = (x_.count() - artwork.cols()) / 2;
  const int top = (y_.count() - artwork.rows()) / 2;
  for (int row = 0; row < y_.count(); ++row) {
    for (int col = 0; col < x_.count(); ++col) {
      const int i = col - left;
      const int j = row - top;
      const bool is_printed = i >= 0 && j >= 0 && i < artwork.cols() && j < artwork.rows();
      inks_[static_cast<std::size_t>(row + 1) * stride_ + static_cast<std::size_t>(col + 1)] =
          is_printed && artwork.is_dark(i, j) ? Ink::kDark : Ink::kLight;
    }
  }
}

bool Scene::is_one_ink(const CellRange& range) const {
  const Ink first = ink({range.left, range.top});
  for (int row = range.top; row <= range.bottom; ++row) {
    for (int col = range.left; col <= range.right; ++col) {
      if (ink({col, row}) != first) return false;
    }
  }
  return true;
}

double Scene::mean_of_parts(const SceneLevels& levels, const PixelCorners& corners,
                            const std::array<Cell, 4>& seen) const {
  const auto [left, right] = std::minmax({seen[0].col, seen[1].col, seen[2].col, seen[3].col});
  const auto [top, bottom] = std::minmax({seen[0].row, seen[1].row, seen[2].row, seen[3].row});
  if (left == kNothing || left >= x_.count() || top >= y_.count() || right < 0 || bottom < 0) {
    return levels.background;
  }
  const CellRange range{left, top, right, bottom};
  std::vector<const Artwork::Disc*> found;
  if (!discs_.is_empty()) discs_.find(area_of(corners), found);
  if (found.empty() && is_one_ink(range)) return levels.of(ink({left, top}));
  Polygon pixel;
  for (const Vertex& corner : corners) pixel.push(corner);
  return mean_of_discs(levels, pixel, range, found);
}

// The uppermost disc parts a polygon. What it does not cover is no polygon to cut further: it is
// the whole without the covered part, as if the disc were not there.
double Scene::mean_of_discs(const SceneLevels& levels, const Polygon& polygon,
                            const CellRange& range, Discs discs) const {
  Polygon covered;
  while (!discs.empty()) {
    const Artwork::Disc& disc = *discs.front();
    const double level = disc.is_dark ? levels.dark : levels.light;
    const Overlap overlap = cut_disc(polygon, disc, covered);
    discs = discs.subspan(1);
    if (overlap == Overlap::kAll) return level * polygon.area();
    if (overlap == Overlap::kPart) {
      return level * covered.area() + mean_of_discs(levels, polygon, range, discs) -
             mean_of_discs(levels, covered, range, discs);
    }
  }
  return mean_of_cells(levels, polygon, range);
}

double Scene::mean_of_cells(const SceneLevels& levels, const Polygon& polygon,
                            const CellRange& range) const {
  if (is_one_ink(range)) return polygon.area() * levels.of(ink({range.left, range.top}));
  double sum = 0;
  Polygon rest = polygon;
  Polygon column;
  Polygon next;
  for (int col = range.left; col < range.right; ++col) {
    cut(rest, {1, 0, x_.end_of(col)}, column, next);
    rest = next;
    sum += mean_of_column(levels, column, col, range.top, range.bottom);
  }
  return sum + mean_of_column(levels, rest, range.right, range.top, range.bottom);
}

double Scene::mean_of_column(const SceneLevels& levels, Polygon column, int col, int top,
                             int bottom) const {
  double sum = 0;
  Polygon piece;
  Polygon next;
  for (int row = top; row < bottom; ++row) {
    if (ink({col, row}) == ink({col, row + 1})) continue;
    cut(column, {0, 1, y_.end_of(row)}, piece, next);
    column = next;
    sum += piece.area() * levels.of(ink({col, row}));
  }
  return sum + column.area() * levels.of(ink({col, bottom}));
}

}  // namespace calvin::synth
