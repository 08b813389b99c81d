// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Andrew's monotone chain, after the points that cannot lie on the hull were dropped.

#include "calvin/geometry/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace calvin {

namespace {

// Positive where a, b, c turn clockwise in the image (y down). The products are compared rather
// than subtracted: where a processor has both in one rounding (FMA, as on ARM), the difference of
// equal products is not 0, and a corner would lie beside itself.
int turn(Pixel a, Pixel b, Pixel c) noexcept {
  const double clockwise = (b.u - a.u) * (c.v - a.v);
  const double against = (b.v - a.v) * (c.u - a.u);
  return (clockwise > against ? 1 : 0) - (clockwise < against ? 1 : 0);
}

// Leaves out what lies within the octagon of the extreme points, which is nearly everything (S.
// Akl, G. Toussaint, A Fast Convex Hull Algorithm, IPL 7(5), 1978).
void drop_inner(std::vector<Pixel>& points) {
  constexpr double kInset = 0.01;  // of the extent, from corners that lie on the octagon
  std::array<Pixel, 8> octagon;
  octagon.fill(points.front());
  const auto sum = [](Pixel p) { return p.u + p.v; };
  const auto difference = [](Pixel p) { return p.v - p.u; };
  for (const Pixel p : points) {
    if (p.u > octagon[0].u) octagon[0] = p;
    if (sum(p) > sum(octagon[1])) octagon[1] = p;
    if (p.v > octagon[2].v) octagon[2] = p;
    if (difference(p) > difference(octagon[3])) octagon[3] = p;
    if (p.u < octagon[4].u) octagon[4] = p;
    if (sum(p) < sum(octagon[5])) octagon[5] = p;
    if (p.v < octagon[6].v) octagon[6] = p;
    if (difference(p) < difference(octagon[7])) octagon[7] = p;
  }
  std::vector<std::array<Pixel, 2>> sides;
  for (std::size_t i = 0; i < octagon.size(); ++i) {
    const Pixel a = octagon[i];
    const Pixel b = octagon[(i + 1) % octagon.size()];
    if (a.u != b.u || a.v != b.v) sides.push_back({a, b});
  }
  const auto inner = [&sides](Pixel p) {
    bool within = true;  // of all sides: no branch to mispredict
    for (const auto& [a, b] : sides) within &= turn(a, b, p) > 0;
    return within;
  };
  // Nearly all of those lie in a rectangle within it, between its corners on the diagonals.
  const double inset_u = kInset * (octagon[0].u - octagon[4].u);
  const double inset_v = kInset * (octagon[2].v - octagon[6].v);
  const double left = std::max(octagon[3].u, octagon[5].u) + inset_u;
  const double right = std::min(octagon[1].u, octagon[7].u) - inset_u;
  const double top = std::max(octagon[5].v, octagon[7].v) + inset_v;
  const double bottom = std::min(octagon[1].v, octagon[3].v) - inset_v;
  const bool has_middle = left < right && top < bottom && inner({left, top}) &&
                          inner({right, top}) && inner({left, bottom}) && inner({right, bottom});
  const auto drops = [&](Pixel p) {
    const bool in_middle = (p.u >= left) & (p.u <= right) & (p.v >= top) & (p.v <= bottom);
    return (has_middle && in_middle) || inner(p);
  };
  points.erase(std::remove_if(points.begin(), points.end(), drops), points.end());
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
  Pixel before = polygon.back();
  for (const Pixel next : polygon) {
    if (turn(before, next, point) < 0) return false;
    before = next;
  }
  return true;
}

}  // namespace calvin
