// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Undistortion written a second time, from the formulae, in double precision and without speed:
// what the library's is compared with.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/remap/map/plane_layout.hpp"
#include "calvin/remap/view.hpp"

namespace calvin::reference {

struct Lens {
  std::string name;
  std::string model;
  std::vector<double> k;  // in the model's order
};

// Distorted over ideal radius.
inline double radial_scale(const Lens& lens, double r) {
  const auto k = [&](std::size_t i) { return i < lens.k.size() ? lens.k[i] : 0.0; };
  const double s = r * r;
  if (lens.model == "fisheye") return 1 + s * (k(0) + s * (k(1) + s * (k(2) + s * k(3))));
  return (1 + s * (k(0) + s * (k(1) + s * k(4)))) / (1 + s * (k(5) + s * (k(6) + s * k(7))));
}

inline double radial_slope(const Lens& lens, double r) {
  constexpr double kStep = 1e-5;
  const auto distorted = [&](double radius) { return radius * radial_scale(lens, radius); };
  return (distorted(r + kStep) - distorted(r - kStep)) / (2 * kStep);
}

// The radius (tan of the angle, or for a fisheye the angle) where the picture starts to fold back.
inline double fold(const Lens& lens) {
  for (double r = 0; r < 8; r += 1e-4) {
    if (radial_slope(lens, r) <= 0) return r;
  }
  return INFINITY;
}

// Ideal point on the plane z = 1 -> distorted, by the formulae of docs/conventions.md.
inline Pixel distort(const Lens& lens, double x, double y) {
  const auto k = [&](std::size_t i) { return i < lens.k.size() ? lens.k[i] : 0.0; };
  const double r2 = x * x + y * y;
  if (lens.model == "fisheye") {
    const double r = std::sqrt(r2);
    if (r == 0) return {x, y};
    const double t = std::atan(r);
    const double d = t * radial_scale(lens, t);
    return {x * d / r, y * d / r};
  }
  if (lens.model == "pinhole") return {x, y};
  const double g = radial_scale(lens, std::sqrt(r2));
  return {x * g + 2 * k(2) * x * y + k(3) * (r2 + 2 * x * x),
          y * g + k(2) * (r2 + 2 * y * y) + 2 * k(3) * x * y};
}

inline Camera camera(const Lens& lens, ImageSize size, double focal, double cx, double cy) {
  std::vector<double> p = {focal, focal * 0.98, cx, cy};
  p.insert(p.end(), lens.k.begin(), lens.k.end());
  return Camera::make(lens.model, size, p).value();
}

// px of the pinhole `output` -> px of the source; `radius` in the measure of fold().
struct Place {
  Pixel pixel;
  double radius;
};
inline Place source_place(const Lens& lens, const Camera& source, const Camera& output, double u,
                          double v) {
  const double x = (u - output.cx()) / output.fx();
  const double y = (v - output.cy()) / output.fy();
  const Pixel d = distort(lens, x, y);
  const double r = std::hypot(x, y);
  return {{source.fx() * d.u + source.cx(), source.fy() * d.v + source.cy()},
          lens.model == "fisheye" ? std::atan(r) : r};
}

// A view that is enlarged, and turned (radians).
inline ViewOptions view_of(double alpha, double zoom, double roll, ImageSize output = {}) {
  ViewOptions view;
  view.alpha = alpha;
  view.zoom = zoom;
  view.roll = roll;
  view.output = output;
  return view;
}

// Where the samples of a plane lie along one axis of the frame, px.
// The first sample may cover pixels `before` them too.
inline std::vector<double> sites(int length, int shift, bool cosited, int before = 0) {
  std::vector<double> all;
  for (int first = -before; first < length; first += 1 << shift) {
    const int last = std::min(first + (1 << shift), length) - 1;
    all.push_back(cosited ? first : (first + last) / 2.0);
  }
  return all;
}

// The place between samples of a position between sites, held at the ends.
inline double sample_at(const std::vector<double>& all, double position) {
  if (position <= all.front()) return 0;
  const auto next = std::lower_bound(all.begin(), all.end(), position);
  if (next == all.end()) return static_cast<double>(all.size() - 1);
  return static_cast<double>(next - all.begin()) - (*next - position) / (*next - *(next - 1));
}

// Bilinear in double precision; `at(x, y)` reads a sample.
template <typename At>
double bilinear(At at, int width, int height, double x, double y) {
  const int x0 = std::min(static_cast<int>(std::floor(x)), width - 1);
  const int y0 = std::min(static_cast<int>(std::floor(y)), height - 1);
  const int x1 = std::min(x0 + 1, width - 1);
  const int y1 = std::min(y0 + 1, height - 1);
  const double a = x - x0;
  const double b = y - y0;
  return (1 - b) * ((1 - a) * at(x0, y0) + a * at(x1, y0)) +
         b * ((1 - a) * at(x0, y1) + a * at(x1, y1));
}

// Keys' cubic with a = -1/2, and Lanczos' kernel with three lobes.
inline double cubic(double t) {
  t = std::abs(t);
  if (t < 1) return 1.5 * t * t * t - 2.5 * t * t + 1;
  return t < 2 ? -0.5 * t * t * t + 2.5 * t * t - 4 * t + 2 : 0;
}
inline double lanczos3(double t) {
  const double a = std::numbers::pi * std::abs(t);
  if (a < 1e-12) return 1;
  return std::abs(t) < 3 ? 3 * std::sin(a) * std::sin(a / 3) / (a * a) : 0;
}

// The sum over a kernel's neighbours in double precision; those beyond the border are the border's.
template <typename At, typename Kernel>
double filtered(At at, Kernel kernel, int width, int height, double x, double y) {
  double sum = 0;
  double weights = 0;
  for (int j = -2; j <= 3; ++j) {
    for (int i = -2; i <= 3; ++i) {
      const int column = static_cast<int>(std::floor(x)) + i;
      const int row = static_cast<int>(std::floor(y)) + j;
      const double w = kernel(x - column) * kernel(y - row);
      weights += w;
      sum += w * at(std::clamp(column, 0, width - 1), std::clamp(row, 0, height - 1));
    }
  }
  return sum / weights;
}

}  // namespace calvin::reference
