// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The polygon that a pixel covers on the board, and how it is cut. Internal.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace calvin::synth {

// A pixel's corner: its place in the pixel, and what it shows of the board plane in homogeneous
// coordinates, (x/w, y/w) in units of the scene. These change over a pixel as the ray does, which
// is nearly linear for any lens, where x/w is not.
struct Vertex {
  float u, v;
  double x, y, w;
};

// A polygon small enough to stay on the stack; convex but for the lens's distortion in one pixel.
struct Polygon {
  std::array<Vertex, 32> vertices;
  std::size_t count = 0;

  void push(const Vertex& vertex) {
    if (count < vertices.size()) vertices[count++] = vertex;
  }
  [[nodiscard]] double area() const {
    double twice = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vertex& a = vertices[i];
      const Vertex& b = vertices[i + 1 < count ? i + 1 : 0];
      twice += static_cast<double>(a.u * b.v - b.u * a.v);
    }
    return std::abs(twice) / 2;
  }
};

// Cuts `all` along coordinate / w = at (Sutherland and Hodgman): the part below it and the rest.
inline void cut(const Polygon& all, double Vertex::*coordinate, double at, Polygon& below,
                Polygon& above) {
  below.count = 0;
  above.count = 0;
  for (std::size_t i = 0; i < all.count; ++i) {
    const Vertex& a = all.vertices[i];
    const Vertex& b = all.vertices[i + 1 < all.count ? i + 1 : 0];
    const double da = a.*coordinate - at * a.w;
    const double db = b.*coordinate - at * b.w;
    (da < 0 ? below : above).push(a);
    if ((da < 0) == (db < 0)) continue;
    const double t = da / (da - db);
    const auto tf = static_cast<float>(t);
    const Vertex crossing = {a.u + tf * (b.u - a.u), a.v + tf * (b.v - a.v), a.x + t * (b.x - a.x),
                             a.y + t * (b.y - a.y), a.w + t * (b.w - a.w)};
    below.push(crossing);
    above.push(crossing);
  }
}

// What the four corners of a pixel show.
using PixelCorners = std::array<Vertex, 4>;

}  // namespace calvin::synth
