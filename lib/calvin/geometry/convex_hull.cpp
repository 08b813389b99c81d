// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/geometry/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

namespace calvin {

namespace {

// Positive where a, b, c turn clockwise in the image (y down).
double turn(Pixel a, Pixel b, Pixel c) noexcept {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

// Leaves out what lies within the octagon of the extreme points, which is nearly everything (S.
// Akl, G. Toussaint, A Fast Convex Hull Algorithm, IPL 7(5), 1978).
void drop_inner(std::vector<Pixel>& points) {
  std::array<Pixel, 8> octagon;
  std::array<double, 8> most;
  most.fill(-std::numeric_limits<double>::infinity());
  for (const Pixel p : points) {
    const double sum = p.u + p.v;
    const double difference = p.v - p.u;
    const std::array<double, 8> reach = {p.u, sum, p.v, difference, -p.u, -sum, -p.v, -difference};
    for (std::size_t i = 0; i < reach.size(); ++i) {
      if (reach[i] > most[i]) {
        most[i] = reach[i];
        octagon[i] = p;
      }
    }
  }
  const auto inner = [&octagon](Pixel p) {
    for (std::size_t i = 0; i < octagon.size(); ++i) {
      const Pixel a = octagon[i];
      const Pixel b = octagon[(i + 1) % octagon.size()];
      const bool side = a.u != b.u || a.v != b.v;
      if (side && !(turn(a, b, p) > 0)) return false;
    }
    return true;
  };
  points.erase(std::remove_if(points.begin(), points.end(), inner), points.end());
}

}  // namespace

std::vector<Pixel> convex_hull(std::vector<Pixel> points) {
  if (points.size() > 16) drop_inner(points);
  std::sort(points.begin(), points.end(),
            [](Pixel a, Pixel b) { return std::tie(a.u, a.v) < std::tie(b.u, b.v); });
  std::vector<Pixel> hull;
  const auto chain = [&hull](auto first, auto last) {
    const std::size_t base = hull.size();
    for (auto it = first; it != last; ++it) {
      while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), *it) <= 0) {
        hull.pop_back();
      }
      hull.push_back(*it);
    }
    if (!hull.empty()) hull.pop_back();  // the first point of the other chain
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
  return hull;
}

double polygon_area(const std::vector<Pixel>& polygon) noexcept {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Pixel a = polygon[i];
    const Pixel b = polygon[(i + 1) % polygon.size()];
    twice += a.u * b.v - b.u * a.v;
  }
  return twice / 2;
}

bool contains(const std::vector<Pixel>& polygon, Pixel point) noexcept {
  if (polygon.size() < 3) return false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (turn(polygon[i], polygon[(i + 1) % polygon.size()], point) < 0) return false;
  }
  return true;
}

}  // namespace calvin
