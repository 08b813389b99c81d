// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The panel in the upper left corner of the overlay: bars of what was spanned so far, and a map of
// where.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "calvin/draw/overlay_shapes.hpp"

namespace calvin {

namespace {

// Red at 0, amber half way, green at 1.
Colour traffic_light(double t) {
  return {std::clamp(2 - 1.8 * t, 0.2, 0.95), std::clamp(0.3 + 1.1 * t, 0.3, 0.85), 0.25, 1};
}

// One stroke of an icon, in a square of side 1.
struct Stroke {
  double x0, y0, x1, y1;
};

constexpr std::array kCoverageIcon = {Stroke{0, 0.1, 1, 0.1}, Stroke{1, 0.1, 1, 0.9},
                                      Stroke{1, 0.9, 0, 0.9}, Stroke{0, 0.9, 0, 0.1},
                                      Stroke{0, 0.5, 1, 0.5}, Stroke{0.5, 0.1, 0.5, 0.9}};
constexpr std::array kAcrossIcon = {Stroke{0, 0.5, 1, 0.5}, Stroke{0, 0.5, 0.25, 0.25},
                                    Stroke{0, 0.5, 0.25, 0.75}, Stroke{1, 0.5, 0.75, 0.25},
                                    Stroke{1, 0.5, 0.75, 0.75}};
constexpr std::array kDownIcon = {Stroke{0.5, 0, 0.5, 1}, Stroke{0.5, 0, 0.25, 0.25},
                                  Stroke{0.5, 0, 0.75, 0.25}, Stroke{0.5, 1, 0.25, 0.75},
                                  Stroke{0.5, 1, 0.75, 0.75}};
constexpr std::array kSizeIcon = {Stroke{0, 0, 1, 0},       Stroke{1, 0, 1, 1},
                                  Stroke{1, 1, 0, 1},       Stroke{0, 1, 0, 0},
                                  Stroke{0, 0.5, 0.5, 0.5}, Stroke{0.5, 0.5, 0.5, 1}};
constexpr std::array kTiltIcon = {Stroke{0.05, 0, 0.95, 0.25}, Stroke{0.95, 0.25, 0.95, 0.75},
                                  Stroke{0.95, 0.75, 0.05, 1}, Stroke{0.05, 1, 0.05, 0}};

struct Bar {
  double Progress::*value;
  std::span<const Stroke> icon;
};
constexpr std::array kBars = {Bar{&Progress::coverage, kCoverageIcon},
                              Bar{&Progress::x, kAcrossIcon}, Bar{&Progress::y, kDownIcon},
                              Bar{&Progress::size, kSizeIcon}, Bar{&Progress::tilt, kTiltIcon}};

// All in px of the frame.
struct PanelSizes {
  explicit PanelSizes(ImageSize frame) : unit(unit_of(frame)) {
    const double most = 1.5 * map_width;  // of a picture that is higher than wide
    map_height = std::min(most, map_width * frame.height / frame.width);
  }
  double unit;
  double icon = 9 * unit;
  double pitch = 14 * unit;
  double length = 72 * unit;
  double margin = 10 * unit;
  double padding = 6 * unit;
  double width = 3 * padding + icon + length;
  double bars_height = 2 * padding + (kBars.size() - 1) * pitch + icon;
  double map_width = width - 2 * padding;
  double map_height = 0;
};

bool has_map(const Progress& progress) { return progress.coverage_map.rows() > 0; }

void add_icon(std::vector<Shape>& shapes, const PanelSizes& sizes, std::span<const Stroke> icon,
              double x, double y) {
  const double side = sizes.icon;
  const double pen = std::max(1.0, sizes.unit);
  for (const Stroke& s : icon) {
    shapes.push_back({Shape::Kind::kLine,
                      {x + s.x0 * side, y + s.y0 * side},
                      {x + s.x1 * side, y + s.y1 * side},
                      0,
                      pen,
                      kWhite,
                      0});
  }
}

void add_bars(std::vector<Shape>& shapes, const PanelSizes& sizes, const Progress& progress) {
  const double left = sizes.margin + 2 * sizes.padding + sizes.icon;
  const double height = 0.6 * sizes.icon;
  double y = sizes.margin + sizes.padding;
  for (const Bar& bar : kBars) {
    add_icon(shapes, sizes, bar.icon, sizes.margin + sizes.padding, y);
    const double raw = progress.*bar.value;
    const double value = std::isfinite(raw) ? std::clamp(raw, 0.0, 1.0) : 0;
    const double top = y + 0.2 * sizes.icon;
    add_box(shapes, left, top, sizes.length, height, kTrack);
    if (value > 0) {
      add_box(shapes, left, top, value * sizes.length, height, traffic_light(value));
    }
    y += sizes.pitch;
  }
}

// The picture as a small one, with what boards have covered of it; cells of a row that lie beside
// each other are one box, of whole px: between two that share a pixel a line would show.
void add_map(std::vector<Shape>& shapes, const PanelSizes& sizes, const CoverageMap& map) {
  const double left = sizes.margin + sizes.padding;
  const double top = sizes.margin + sizes.bars_height;
  const auto x = [&](int column) {
    return std::round(left + column * sizes.map_width / map.columns);
  };
  const auto y = [&](int row) { return std::round(top + row * sizes.map_height / map.rows()); };
  add_box(shapes, x(0), y(0), x(map.columns) - x(0), y(map.rows()) - y(0), kTrack);
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns; ++column) {
      int end = column;
      while (end < map.columns && map.is_covered(end, row)) ++end;
      if (end == column) continue;
      add_box(shapes, x(column), y(row), x(end) - x(column), y(row + 1) - y(row), kGreen);
      column = end;
    }
  }
}

}  // namespace

int overlay_panel_right(ImageSize frame) noexcept {
  const PanelSizes sizes(frame);
  return static_cast<int>(2 * sizes.margin + sizes.width);
}

void add_panel(std::vector<Shape>& shapes, ImageSize frame, const Progress& progress) {
  const PanelSizes sizes(frame);
  const double below = has_map(progress) ? sizes.map_height + sizes.padding : 0;
  add_box(shapes, sizes.margin, sizes.margin, sizes.width, sizes.bars_height + below, kPanel);
  add_bars(shapes, sizes, progress);
  if (has_map(progress)) add_map(shapes, sizes, progress.coverage_map);
}

}  // namespace calvin
