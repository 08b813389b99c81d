// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rectangles by which cv::getOptimalNewCameraMatrix() chooses its view, as OpenCV has them.

#include "calvin/remap/opencv_rectangles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "calvin/camera/lens_table.hpp"
#include "calvin_config.h"

namespace calvin {

namespace {

constexpr int kPoints = 9;  // along each side

// Distortion coefficients in OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 taux tauy.
using Coefficients = std::array<double, 14>;

// The coefficients of a camera; absent for a model that OpenCV undistorts by another function, or
// not at all.
std::optional<Coefficients> coefficients_of(const Camera& camera) {
  if (find_lens(camera.model())->opencv != OpenCvForm::kBrown) return std::nullopt;
  Coefficients k = {};
  std::copy(camera.parameters().begin() + 4, camera.parameters().end(), k.begin());
  return k;
}

// Takes a point off the sensor that is tilted by (taux, tauy), by rotating it back.
Pixel untilted(Pixel p, double taux, double tauy) {
  const double cx = std::cos(taux);
  const double sx = std::sin(taux);
  const double cy = std::cos(tauy);
  const double sy = std::sin(tauy);
  const double w = cx * cy / (1 - cx * sy * p.u + sx * p.v);
  const double x = w * p.u / cx;
  return {x, (w * p.v + sx * sy * x) / cy};
}

// Distorted -> ideal on the plane z = 1: x = (x_d - shift(x)) / factor(x), five times from x = x_d.
Pixel five_steps(const Coefficients& k, Pixel seen) {
  constexpr int kSteps = 5;
  const Pixel from = untilted(seen, k[12], k[13]);
  Pixel p = from;
  for (int i = 0; i < kSteps; ++i) {
    const double r2 = p.u * p.u + p.v * p.v;
    const double inverse =
        (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]))) / (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4])));
    // OpenCV leaves the point as it was seen.
    if (inverse < 0) return seen;
    const double u = 2 * k[2] * p.u * p.v + k[3] * (r2 + 2 * p.u * p.u) + r2 * (k[8] + r2 * k[9]);
    const double v = k[2] * (r2 + 2 * p.v * p.v) + 2 * k[3] * p.u * p.v + r2 * (k[10] + r2 * k[11]);
    p = {(from.u - u) * inverse, (from.v - v) * inverse};
  }
  return p;
}

// The ideal point of a source pixel on the plane of the projection.
std::optional<Pixel> ideal_point(const Camera& source, const std::optional<Coefficients>& k,
                                 Projection projection, Pixel pixel) {
  if (!k) {
    const auto ray = source.unproject(pixel);
    return ray ? to_plane(projection, *ray) : std::nullopt;
  }
  const double y = (pixel.v - source.cy()) / source.fy();
  const Pixel p = five_steps(*k, {(pixel.u - source.cx() - source.skew() * y) / source.fx(), y});
  if (!std::isfinite(p.u) || !std::isfinite(p.v)) return std::nullopt;
  return to_plane(projection, {p.u, p.v, 1});
}

}  // namespace

OpenCvGrid opencv_grid() noexcept {
  return CALVIN_OPENCV_PAST_THE_EDGE ? OpenCvGrid::kPastTheEdge : OpenCvGrid::kPixels;
}

OpenCvRectangles opencv_rectangles(const Camera& source, Projection projection, OpenCvGrid grid) {
  const auto k = coefficients_of(source);
  const double past = grid == OpenCvGrid::kPastTheEdge ? 0 : 1;
  const double right = source.image_size().width - past;
  const double bottom = source.image_size().height - past;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  PlaneBox inner = {{-kFar, -kFar}, {kFar, kFar}};
  PlaneBox outer = {{kFar, kFar}, {-kFar, -kFar}};
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      const auto p = ideal_point(source, k, projection,
                                 {i * right / (kPoints - 1), j * bottom / (kPoints - 1)});
      if (!p) continue;
      outer.low = {std::min(outer.low.u, p->u), std::min(outer.low.v, p->v)};
      outer.high = {std::max(outer.high.u, p->u), std::max(outer.high.v, p->v)};
      if (i == 0) inner.low.u = std::max(inner.low.u, p->u);
      if (i == kPoints - 1) inner.high.u = std::min(inner.high.u, p->u);
      if (j == 0) inner.low.v = std::max(inner.low.v, p->v);
      if (j == kPoints - 1) inner.high.v = std::min(inner.high.v, p->v);
    }
  }
  return {inner, outer};
}

}  // namespace calvin
