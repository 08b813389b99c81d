// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/geometry/convex_hull.hpp"

#include <algorithm>
#include <tuple>

namespace calvin {

namespace {

// Positive where a, b, c turn clockwise in the image (y down).
double turn(Pixel a, Pixel b, Pixel c) noexcept {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

}  // namespace

std::vector<Pixel> convex_hull(std::vector<Pixel> points) {
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
