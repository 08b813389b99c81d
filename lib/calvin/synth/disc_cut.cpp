// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cuts along lines that stand for the part of a circle within a pixel and enclose as much as it
// does.

#include "calvin/synth/disc_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace calvin::synth {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 3e-5;  // of the area of a pixel
constexpr double kMostLines = 40;
constexpr double kWidest = kPi / 4;  // rad

// What a polygon covers of the board plane, seen from the centre of a disc.
struct Footprint {
  double distance = 0;   // of its middle, m
  double direction = 0;  // rad
  double reach = 0;      // from its middle, m
  double farthest = 0;   // of it, m
  double area = 0;       // m^2
};

Footprint footprint_of(const Polygon& polygon, const Artwork::Disc& disc) {
  std::array<std::array<double, 2>, Polygon::kMost> places;
  Footprint f;
  double x = 0;
  double y = 0;
  const std::size_t n = polygon.count;
  for (std::size_t i = 0; i < n; ++i) {
    const Vertex& p = polygon.vertices[i];
    places[i] = {p.x / p.w - disc.x, p.y / p.w - disc.y};
    x += places[i][0] / static_cast<double>(n);
    y += places[i][1] / static_cast<double>(n);
    f.farthest = std::max(f.farthest, std::hypot(places[i][0], places[i][1]));
  }
  double twice = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& a = places[i];
    const auto& b = places[i + 1 < n ? i + 1 : 0];
    f.reach = std::max(f.reach, std::hypot(a[0] - x, a[1] - y));
    twice += a[0] * b[1] - b[0] * a[1];
  }
  f.distance = std::hypot(x, y);
  f.direction = std::atan2(y, x);
  f.area = std::abs(twice) / 2;
  return f;
}

// Half the angle, rad, within which the circle may part what lies in the footprint's own circle.
double half_angle(const Footprint& f, double radius) {
  const double d = f.distance;
  if (d > f.reach && radius * radius < d * d - f.reach * f.reach) return std::asin(f.reach / d);
  if (d <= 0) return kPi;
  const double cosine = (d * d + radius * radius - f.reach * f.reach) / (2 * d * radius);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

// The number of lines that stand for an angle of the circle. Between two of its points a line errs
// by up to 0.016 r^2 angle^3, as the integral over a line that encloses as much as its arc does.
double lines_for(double angle, const Footprint& f, double radius) {
  const double each = std::cbrt(kTolerance * f.area / (0.016 * radius * radius));
  return std::clamp(std::ceil(angle / std::min(each, kWidest)), 1.0, kMostLines);
}

}  // namespace

Overlap cut_disc(const Polygon& all, const Artwork::Disc& disc, Polygon& inside) {
  const double radius = disc.diameter / 2;
  const Footprint f = footprint_of(all, disc);
  if (f.farthest <= radius) return Overlap::kAll;
  if (!(f.distance < radius + f.reach)) return Overlap::kNone;
  const double half = half_angle(f, radius);
  const double lines = lines_for(2 * half, f, radius);
  const double step = 2 * half / lines;
  if (!(step > 0)) return Overlap::kAll;
  const double apothem = radius * std::sqrt(step / 2 / std::tan(step / 2));
  inside = all;
  Polygon before;
  Polygon outside;
  for (int i = 0; i < static_cast<int>(lines); ++i) {
    const double angle = f.direction - half + (i + 0.5) * step;
    const double a = std::cos(angle);
    const double b = std::sin(angle);
    before = inside;
    cut(before, {a, b, a * disc.x + b * disc.y + apothem}, inside, outside);
    if (inside.count == 0) return Overlap::kNone;
  }
  return Overlap::kPart;
}

}  // namespace calvin::synth
