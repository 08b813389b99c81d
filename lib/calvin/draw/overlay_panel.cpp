// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The panel in an upper corner of the overlay: bars of what was spanned so far and chips of what is
// known of the camera or, once nothing more is needed, the calibration; and a map of the picture.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "calvin/camera/image_transform.hpp"
#include "calvin/draw/overlay_layout.hpp"
#include "calvin/draw/overlay_shapes.hpp"

namespace calvin {

namespace {

// Red at 0, amber half way, green at 1.
Colour traffic_light(double t) {
  return {std::clamp(2 - 1.8 * t, 0.2, 0.95), std::clamp(0.3 + 1.1 * t, 0.3, 0.85), 0.25, 1};
}

// One stroke of an icon, in a square of side 1.
struct IconLine {
  double x0, y0, x1, y1;
};

constexpr std::array kCoverageIcon = {IconLine{0, 0.1, 1, 0.1}, IconLine{1, 0.1, 1, 0.9},
                                      IconLine{1, 0.9, 0, 0.9}, IconLine{0, 0.9, 0, 0.1},
                                      IconLine{0, 0.5, 1, 0.5}, IconLine{0.5, 0.1, 0.5, 0.9}};
constexpr std::array kAcrossIcon = {IconLine{0, 0.5, 1, 0.5}, IconLine{0, 0.5, 0.25, 0.25},
                                    IconLine{0, 0.5, 0.25, 0.75}, IconLine{1, 0.5, 0.75, 0.25},
                                    IconLine{1, 0.5, 0.75, 0.75}};
constexpr std::array kDownIcon = {IconLine{0.5, 0, 0.5, 1}, IconLine{0.5, 0, 0.25, 0.25},
                                  IconLine{0.5, 0, 0.75, 0.25}, IconLine{0.5, 1, 0.25, 0.75},
                                  IconLine{0.5, 1, 0.75, 0.75}};
constexpr std::array kSizeIcon = {IconLine{0, 0, 1, 0},       IconLine{1, 0, 1, 1},
                                  IconLine{1, 1, 0, 1},       IconLine{0, 1, 0, 0},
                                  IconLine{0, 0.5, 0.5, 0.5}, IconLine{0.5, 0.5, 0.5, 1}};
constexpr std::array kTiltIcon = {IconLine{0.05, 0, 0.95, 0.25}, IconLine{0.95, 0.25, 0.95, 0.75},
                                  IconLine{0.95, 0.75, 0.05, 1}, IconLine{0.05, 1, 0.05, 0}};

struct Bar {
  double Progress::*value;
  std::span<const IconLine> icon;
  const char* words;
};
constexpr std::array kBars = {
    Bar{&Progress::coverage, kCoverageIcon, "covered"},
    Bar{&Progress::x, kAcrossIcon, "left, right"}, Bar{&Progress::y, kDownIcon, "up, down"},
    Bar{&Progress::size, kSizeIcon, "size"}, Bar{&Progress::tilt, kTiltIcon, "tilt"}};
// Anybody may write a meta.
constexpr std::size_t kMostChips = 4;
constexpr std::size_t kMostLines = 20;

// A text is there for whoever can draw words: else the bars stay.
bool shows_summary(const Progress& progress) { return progress.done && !progress.summary.empty(); }

std::size_t lines_of(const Progress& progress) {
  if (shows_summary(progress)) return std::min(progress.summary.size(), kMostLines);
  return kBars.size() + std::min(progress.parameters.size(), kMostChips);
}

bool is_under(const OverlayBox& box, Pixel at) {
  return at.u >= box.x && at.u < box.x + box.width && at.v >= box.y && at.v < box.y + box.height;
}

bool has_map(const Progress& progress) { return progress.coverage_map.rows() > 0; }

// Where the parts of the panel are, all in px of the frame.
struct PanelLayout {
  PanelLayout(ImageSize frame, const Progress& progress, PanelSide side) : unit(unit_of(frame)) {
    lines_height = 2 * padding + static_cast<double>(lines_of(progress) - 1) * pitch + icon;
    map_height = std::min(1.5 * map_width, map_width * frame.height / frame.width);
    height = lines_height + (has_map(progress) ? map_height + padding : 0);
    left = side == PanelSide::kLeft ? margin : frame.width - margin - width;
  }

  // Of a line of the panel, half way up.
  [[nodiscard]] double middle(std::size_t line) const {
    return top + padding + icon / 2 + static_cast<double>(line) * pitch;
  }

  double unit;
  double icon = 9 * unit;
  double pitch = 14 * unit;
  double bar = 11 * unit;  // its height
  double length = 88 * unit;
  double margin = 10 * unit;
  double padding = 6 * unit;
  double width = 3 * padding + icon + length;
  double map_width = width - 2 * padding;
  double left = 0;
  double top = margin;
  double lines_height = 0;
  double map_height = 0;  // of a picture that is not much higher than wide: as it is
  double height = 0;
};

void add_icon(std::vector<Shape>& shapes, const PanelLayout& panel, std::span<const IconLine> icon,
              double middle) {
  const double side = panel.icon;
  const double pen = std::max(1.0, panel.unit);
  const double x = panel.left + panel.padding;
  const double y = middle - side / 2;
  for (const IconLine& s : icon) {
    shapes.push_back({Shape::Kind::kLine,
                      {x + s.x0 * side, y + s.y0 * side},
                      {x + s.x1 * side, y + s.y1 * side},
                      0,
                      pen,
                      kWhite,
                      0});
  }
}

double part(double value) { return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 0; }

void add_bar(std::vector<Shape>& shapes, const PanelLayout& panel, double left, double middle,
             double value) {
  const double length = panel.left + panel.width - panel.padding - left;
  const double top = middle - panel.bar / 2;
  const double filled = part(value);
  add_box(shapes, left, top, length, panel.bar, kTrack);
  if (filled <= 0) return;
  add_box(shapes, left, top, filled * length, panel.bar, traffic_light(filled));
}

void add_bars(std::vector<Shape>& shapes, const PanelLayout& panel, const Progress& progress) {
  const double left = panel.left + 2 * panel.padding + panel.icon;
  for (std::size_t i = 0; i < kBars.size(); ++i) {
    add_icon(shapes, panel, kBars[i].icon, panel.middle(i));
    add_bar(shapes, panel, left, panel.middle(i), progress.*kBars[i].value);
  }
}

// What is known of the camera, wider than what was seen by the room of the icons.
void add_chips(std::vector<Shape>& shapes, const PanelLayout& panel, const Progress& progress) {
  const std::size_t count = std::min(progress.parameters.size(), kMostChips);
  for (std::size_t i = 0; i < count; ++i) {
    add_bar(shapes, panel, panel.left + panel.padding, panel.middle(kBars.size() + i),
            progress.parameters[i].known);
  }
}

// The picture as a small one, with what boards have covered of it; cells of a row that lie beside
// each other are one box, of whole px: between two that share a pixel a line would show.
void add_map(std::vector<Shape>& shapes, const PanelLayout& panel, const CoverageMap& map) {
  const double left = panel.left + panel.padding;
  const double top = panel.top + panel.lines_height;
  const auto x = [&](int column) {
    return std::round(left + column * panel.map_width / map.columns);
  };
  const auto y = [&](int row) { return std::round(top + row * panel.map_height / map.rows()); };
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

OverlayBox overlay_panel_box(ImageSize frame, const Progress& progress, PanelSide side) {
  const PanelLayout panel(frame, progress, side);
  OverlayBox box;
  box.x = static_cast<int>(std::floor(panel.left));
  box.y = static_cast<int>(std::floor(panel.top));
  box.width = static_cast<int>(std::ceil(panel.left + panel.width)) - box.x;
  box.height = static_cast<int>(std::ceil(panel.top + panel.height)) - box.y;
  return box;
}

std::vector<OverlayWords> overlay_panel_words(ImageSize frame, const Progress& progress,
                                              PanelSide side) {
  const PanelLayout panel(frame, progress, side);
  std::vector<OverlayWords> words;
  // Numbers are longer than words.
  const double size = (shows_summary(progress) ? 8.5 : 9.5) * panel.unit;
  const auto add = [&](std::string text, double left) {
    const double room = panel.left + panel.width - panel.padding - left;
    words.push_back({std::move(text), {left, panel.middle(words.size())}, room, size});
  };
  const double left = panel.left + panel.padding;
  if (shows_summary(progress)) {
    for (std::size_t i = 0; i < lines_of(progress); ++i) add(progress.summary[i], left);
    return words;
  }
  const double indent = 4 * panel.unit;
  for (const Bar& bar : kBars) add(bar.words, left + panel.icon + panel.padding + indent);
  for (std::size_t i = 0; words.size() < lines_of(progress); ++i) {
    add(progress.parameters[i].name, left + indent);
  }
  if (has_map(progress)) {
    words.push_back({"where boards were",
                     {left + indent, panel.top + panel.lines_height + panel.icon},
                     panel.map_width - indent,
                     size});
  }
  return words;
}

OverlaySpan beside_panel(const OverlayBox& panel, ImageSize frame) {
  const int margin = panel.y;
  const int middle = frame.width / 2;
  if (panel.x >= middle) return {0, std::max(middle, panel.x - margin)};
  return {std::min(middle, panel.x + panel.width + margin), frame.width};
}

bool hides_corner(const OverlayBox& box, std::span<const Observation> seen, ImageSize frame) {
  return std::ranges::any_of(seen, [&](const Observation& o) {
    if (o.image_size.width < 1 || o.image_size.height < 1) return false;
    const auto to_frame = ImageTransform::scaled(o.image_size, frame);
    return std::ranges::any_of(o.uv, [&](Pixel at) { return is_under(box, to_frame(at)); });
  });
}

bool hides_square(const OverlayBox& box, std::span<const Observation> seen, ImageSize frame) {
  return std::ranges::any_of(seen, [&](const Observation& o) {
    if (o.image_size.width < 1 || o.image_size.height < 1 || o.uv.size() < 2) return false;
    const auto to_frame = ImageTransform::scaled(o.image_size, frame);
    // Of corners in the order of their ids most are next to the one before.
    std::vector<double> apart;
    for (std::size_t i = 1; i < o.uv.size(); ++i) {
      const Pixel one = to_frame(o.uv[i - 1]);
      const Pixel next = to_frame(o.uv[i]);
      const double distance = std::hypot(next.u - one.u, next.v - one.v);
      if (std::isfinite(distance)) apart.push_back(distance);
    }
    if (apart.empty()) return false;
    const auto middle = apart.begin() + static_cast<std::ptrdiff_t>(apart.size() / 2);
    std::ranges::nth_element(apart, middle);
    const int side = static_cast<int>(std::min(*middle, 1.0 * frame.width));
    const OverlayBox around = {box.x - side, box.y - side, box.width + 2 * side,
                               box.height + 2 * side};
    return hides_corner(around, {&o, 1}, frame);
  });
}

bool hides_outline(const OverlayBox& box, std::span<const Pixel> outline, ImageSize frame) {
  return std::ranges::any_of(outline, [&](const Pixel& part) {
    return is_under(box, {coordinate_at(part.u, frame.width), coordinate_at(part.v, frame.height)});
  });
}

void add_panel(std::vector<Shape>& shapes, ImageSize frame, const Progress& progress,
               const OverlayParts& parts) {
  const PanelLayout panel(frame, progress, parts.panel);
  add_box(shapes, panel.left, panel.top, panel.width, panel.height, kPanel);
  if (!parts.words || !shows_summary(progress)) {
    add_bars(shapes, panel, progress);
    add_chips(shapes, panel, progress);
  }
  if (has_map(progress)) add_map(shapes, panel, progress.coverage_map);
}

}  // namespace calvin
