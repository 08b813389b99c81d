// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Beginnings, windows and tests of the fits of nodes.

#include "calvin/detect/checkerboard/fits/node_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calvin/detect/checkerboard/corners/fit_radius.hpp"
#include "calvin/target/puzzle_board.hpp"

namespace calvin::detect {

namespace {

// px, from a node's edge that crosses the way to the next node, which is there, to that node.
float distance_to_next(const Lattice& lattice, Cell c, Cell step) {
  const Node& node = lattice.at(c);
  const Node& next = lattice.at(c + step);
  const Direction edge = step.row == 0 ? node.down : node.along;
  return std::abs(cross(edge, {next.x - node.x, next.y - node.y}));
}

}  // namespace

float spacing_at(const Lattice& lattice, Cell c) {
  float least = 1e6F;
  for (const Cell step : kAround) {
    if (lattice.has(c + step)) {
      // The line on the other side may be nearer, and have no node here.
      const float other = lattice.length(c, -1 * step) / lattice.length(c, step);
      least = std::min(least, std::min(1.0F, other) * distance_to_next(lattice, c, step));
      continue;
    }
    if (lattice.has(c - step)) continue;
    // Of a node at the end of its line the next one tells how far the lines beside it are.
    for (const Cell aside : {Cell{step.row, step.col}, Cell{-step.row, -step.col}}) {
      if (!lattice.has(c + aside) || !lattice.has(c + aside + step)) continue;
      least = std::min(least, distance_to_next(lattice, c + aside, step));
    }
  }
  return least;
}

namespace {

// px, from a node to the next one of an axis, or to where it would be; none where none is there.
std::optional<Direction> step_at(const Lattice& lattice, Cell c, Cell axis) {
  const Node& node = lattice.at(c);
  for (const int side : {1, -1}) {
    if (!lattice.has(c + side * axis)) continue;
    const Node& next = lattice.at(c + side * axis);
    const auto sign = static_cast<float>(side);
    return Direction{sign * (next.x - node.x), sign * (next.y - node.y)};
  }
  return std::nullopt;
}

bool has_dots(const Node& node) {
  return std::ranges::any_of(node.dots, [](std::int8_t dot) { return dot != 0; });
}

}  // namespace

EdgeDots dots_at(const Lattice& lattice, Cell c) {
  constexpr auto kRadius = static_cast<float>(PuzzleBoard::kDotDiameter / 2);
  EdgeDots dots;
  const Node& node = lattice.at(c);
  if (!has_dots(node)) return dots;
  const auto along = step_at(lattice, c, {1, 0});
  const auto down = step_at(lattice, c, {0, 1});
  if (!along || !down) return dots;
  for (std::size_t way = 0; way < 4; ++way) {
    if (node.dots[way] == 0) continue;
    EdgeDot& dot = dots.all[static_cast<std::size_t>(dots.count++)];
    dot.light = node.dots[way] > 0;
    dot.on_along = way % 2 == 0;
    const Direction step = dot.on_along ? *along : *down;
    const Direction other = dot.on_along ? *down : *along;
    // The next corner of this side tells the middle of the edge best.
    const Cell to = c + kAround[way];
    const float half = way < 2 ? 0.5F : -0.5F;
    dot.center = {half * step.x, half * step.y};
    if (lattice.has(to)) {
      const Node& next = lattice.at(to);
      dot.center = {0.5F * (next.x - node.x), 0.5F * (next.y - node.y)};
    }
    dot.along_edge = {2 * kRadius * dot.center.x, 2 * kRadius * dot.center.y};
    dot.across = {kRadius * other.x, kRadius * other.y};
  }
  return dots;
}

float clear_at(const Lattice& lattice, Cell c) {
  return lattice.surroundings().clear(spacing_at(lattice, c));
}

float room_at(const Lattice& lattice, Cell c) {
  return lattice.surroundings().room(spacing_at(lattice, c), lattice.at(c).width);
}

float closest_radius(float spacing) {
  constexpr float kClosest = 0.3F;        // of the spacing
  constexpr float kClosestRadius = 2.2F;  // px
  return std::clamp(kClosest * spacing, kClosestRadius, kCloseRadius);
}

SaddleFit fit_of(const Node& node) {
  SaddleFit fit;
  fit.x = static_cast<double>(node.x);
  fit.y = static_cast<double>(node.y);
  fit.along = node.along;
  fit.down = node.down;
  fit.along_width = fit.down_width = node.width;
  return fit;
}

void expect_directions(const Lattice& lattice, Cell c, ExpectedEdges& expected) {
  float n = 0, col = 0, row = 0, cols = 0, rows = 0, both = 0;
  Direction place, by_col, by_row;
  place = by_col = by_row = {0, 0};
  for (int dr = -1; dr <= 1; ++dr) {
    for (int dc = -1; dc <= 1; ++dc) {
      if (!lattice.has(c + Cell{dc, dr})) continue;
      const Node& node = lattice.at(c + Cell{dc, dr});
      const float u = lattice.place(c.col + dc, true) - lattice.place(c.col, true);
      const float v = lattice.place(c.row + dr, false) - lattice.place(c.row, false);
      const Direction p = {node.x - lattice.at(c).x, node.y - lattice.at(c).y};
      n += 1;
      col += u;
      row += v;
      cols += u * u;
      rows += v * v;
      both += u * v;
      place = {place.x + p.x, place.y + p.y};
      by_col = {by_col.x + u * p.x, by_col.y + u * p.y};
      by_row = {by_row.x + v * p.x, by_row.y + v * p.y};
    }
  }
  const float a = cols - col * col / n;
  const float b = both - col * row / n;
  const float d = rows - row * row / n;
  const float determinant = a * d - b * b;
  if (!(determinant > 0.1F)) return;
  const Direction right = {by_col.x - col * place.x / n, by_col.y - col * place.y / n};
  const Direction below = {by_row.x - row * place.x / n, by_row.y - row * place.y / n};
  const auto unit = [](Direction w, Direction otherwise) {
    const float length = std::hypot(w.x, w.y);
    return length > 0 ? Direction{w.x / length, w.y / length} : otherwise;
  };
  expected.along = unit({d * right.x - b * below.x, d * right.y - b * below.y}, expected.along);
  expected.down = unit({a * below.x - b * right.x, a * below.y - b * right.y}, expected.down);
}

void take_widths(const SaddleFit& from, float least, SaddleFit& fit) {
  fit.along_width = std::max(from.along_width, least);
  fit.down_width = std::max(from.down_width, least);
}

SaddleFit parted_fit(SaddleFit fit) {
  constexpr float kPartedWidth = 2;  // px, from which the steps find the gap
  fit.contrast = 0;
  fit.along_width = fit.down_width = kPartedWidth;
  fit.has_gain = true;
  return fit;
}

void fit_parted(const ImageView& image, float radius, int steps, SaddleFit& fit) {
  constexpr float kOfSwing = 0.06F;   // the residual that no noise explains
  constexpr float kLeastGain = 0.1F;  // px: with less, one unknown more only hides other errors
  if (fit.has_gain || fit.residual < kOfSwing * fit.swing()) return;
  SaddleFit parted = parted_fit(fit);
  if (fit_saddle(image, radius, 2 * steps, parted, kRoughly) && parted.residual < fit.residual &&
      parted.noise < kOfNoise * fit.noise && std::abs(parted.gain) > kLeastGain) {
    fit = parted;
  }
}

bool is_noisy(const SaddleFit& fit, float most) {
  constexpr float kMore = 1.5F;  // of what is told by all residuals, not by opposite pixels
  return !(fit.noise <= (fit.at_border ? kMore : 1) * most * fit.swing());
}

bool colours_fit(const SaddleFit& fit, Cell c) { return (fit.contrast > 0) == Lattice::is_even(c); }

float distance(const SaddleFit& fit, const Node& node) {
  return std::hypot(static_cast<float>(fit.x) - node.x, static_cast<float>(fit.y) - node.y);
}

SaddleFit inner_fit(const ImageView& image, const SaddleFit& outer) {
  // The difference of the places of two windows tells the bend best with about this ratio of their
  // radii.
  constexpr float kInner = 0.55F;
  constexpr float kLeast = 6;  // px
  SaddleFit fit = outer;
  const float radius = kInner * outer.radius;
  if (!(radius >= kLeast) || !fit_saddle(image, radius, 4, fit)) fit.radius = 0;
  return fit;
}

void take(const SaddleFit& fit, Node& node) {
  node.x = static_cast<float>(fit.x);
  node.y = static_cast<float>(fit.y);
  node.along = fit.along;
  node.down = fit.down;
  node.contrast = 2 * fit.swing();
  node.width = std::max(fit.along_width, fit.down_width);
  node.sigma = fit.sigma;
}

void put_between_neighbours(Lattice& lattice, Cell c) {
  for (const Cell step : {Cell{1, 0}, Cell{0, 1}}) {
    if (!lattice.has(c + step) || !lattice.has(c - step)) continue;
    const auto expected = lattice.expect(c);
    if (!expected) return;
    const Node& beside = lattice.at(c + step);
    Node& node = lattice.at(c);
    node.x = expected->x;
    node.y = expected->y;
    node.along = beside.along;
    node.down = beside.down;
    node.width = beside.width;
    return;
  }
}

SaddleFit quick_fit(const ImageView& image, const Lattice& lattice, Cell c, float radius,
                    SaddleFit f, int steps) {
  const Node& node = lattice.at(c);
  const float spacing = spacing_at(lattice, c);
  f.room = room_at(lattice, c);
  radius = std::clamp(kShare * clear_at(lattice, c), kLeastRadius, radius);
  bool good = fit_saddle(image, radius, steps, f, kRoughly);
  if (!good) {
    SaddleFit start = fit_of(node);
    start.room = f.room;
    f = parted_fit(start);
    good = fit_saddle(image, radius, 2 * steps, f, kRoughly);
  }
  if (good && f.residual > kOfNoise * f.noise) fit_parted(image, radius, steps, f);
  good = good && colours_fit(f, c) && distance(f, node) < std::max(1.5F, kLargestMove * spacing);
  if (!good) f.noise = std::numeric_limits<float>::infinity();
  return f;
}

namespace {

// Whether the next corner is likely to look as a fit: noise spoils its widths.
bool is_clear(const SaddleFit& fit) {
  constexpr float kMost = 0.05F;  // noise, of the contrast
  return !fit.has_gain && fit.noise <= kMost * fit.swing();
}

// Where the fit of a node begins that is likely to look as the one before it.
SaddleFit fit_like(const SaddleFit& last, const Node& node, Cell c) {
  constexpr float kNarrowest = 0.5F;  // px: with less, pixels near the edges are too few
  SaddleFit fit = fit_of(node);
  take_widths(last, kNarrowest, fit);
  fit.level = last.level;
  fit.contrast = Lattice::is_even(c) ? std::abs(last.contrast) : -std::abs(last.contrast);
  return fit;
}

}  // namespace

SaddleFit first_fit(const ImageView& image, const Lattice& lattice, Cell c, SaddleFit& last) {
  const auto is_good = [](const SaddleFit& f) { return f.noise <= kMostNoise * f.swing(); };
  const Node& node = lattice.at(c);
  SaddleFit best;
  best.noise = std::numeric_limits<float>::infinity();
  if (last.contrast != 0) {
    best = quick_fit(image, lattice, c, kFirstRadius, fit_like(last, node, c), 8);
  }
  if (!is_good(best)) {
    const SaddleFit f = quick_fit(image, lattice, c, kFirstRadius, fit_of(node), 8);
    if (f.noise < best.noise) best = f;
  }
  // A badly placed node needs a larger window, one with something else near it a smaller one.
  for (const bool wide : {true, false}) {
    if (is_good(best)) break;
    SaddleFit start = fit_of(node);
    if (wide) start.along_width = start.down_width = std::max(2.5F, 1.5F * node.width);
    const SaddleFit f = wide ? quick_fit(image, lattice, c, kLastRadius, start, 12)
                             : quick_fit(image, lattice, c, kCloseRadius, start, 8);
    if (f.noise < best.noise) best = f;
  }
  if (is_clear(best)) last = best;
  return best;
}

}  // namespace calvin::detect
