// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The polygon that a pixel covers on the board, and how it is cut. Internal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace calvin::synth {

// A pixel's corner: its place in the pixel, and what it shows of the board plane in homogeneous
// coordinates, (x/w, y/w) in m. These change over a pixel as the ray does, which is nearly linear
// for any lens, where x/w is not.
struct Vertex {
  float u, v;
  double x, y, w;
};

// A polygon small enough to stay on the stack; convex but for the lens's distortion in one pixel.
struct Polygon {
  static constexpr std::size_t kMost = 96;

  std::array<Vertex, kMost> vertices;
  std::size_t count = 0;

  Polygon() {}  // NOLINT: the vertices beyond the count are never read
  Polygon(const Polygon& other) { *this = other; }
  Polygon& operator=(const Polygon& other) {
    count = other.count;
    std::copy_n(other.vertices.begin(), count, vertices.begin());
    return *this;
  }
  ~Polygon() = default;

  void push(const Vertex& vertex) {
    if (count < vertices.size()) vertices[count++] = vertex;
  }
  [[nodiscard]] const Vertex& after(std::size_t i) const {
    return vertices[i + 1 < count ? i + 1 : 0];
  }
  // px
  [[nodiscard]] double area() const {
    double twice = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vertex& a = vertices[i];
      const Vertex& b = after(i);
      twice += static_cast<double>(a.u * b.v - b.u * a.v);
    }
    return std::abs(twice) / 2;
  }
};

// A line of the board plane, a x + b y = c.
struct Line {
  double a, b, c;
};

// Cuts `all` along a line (Sutherland and Hodgman): the part with the smaller a x + b y and the
// rest.
inline void cut(const Polygon& all, const Line& line, Polygon& below, Polygon& above) {
  const auto side = [&line](const Vertex& p) { return line.a * p.x + line.b * p.y - line.c * p.w; };
  below.count = 0;
  above.count = 0;
  for (std::size_t i = 0; i < all.count; ++i) {
    const Vertex& a = all.vertices[i];
    const Vertex& b = all.after(i);
    const double da = side(a);
    const double db = side(b);
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
