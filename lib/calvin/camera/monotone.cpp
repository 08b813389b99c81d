// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the pixels of the border and of a grid along their rays and back, and tells the first that
// has no ray.

#include "calvin/camera/monotone.hpp"

#include <cmath>

#include <fmt/format.h>

namespace calvin {

namespace {

constexpr int kGrid = 32;  // cells each way inside the image
// To see whether there is anything: px along the border, between which a line that curves like the
// border of the image reaches in by a small part of a pixel.
constexpr int kApart = 32;
constexpr int kFewCells = 8;
constexpr double kReturn = 1e-6;      // of the image width
constexpr double kShowsEdges = 0.95;  // of the way to the corners

bool has_ray(const Camera& camera, Pixel p) {
  const auto ray = camera.unproject(p);
  if (!ray) return false;
  const auto back = camera.project(*ray);
  return back && std::hypot(back->u - p.u, back->v - p.v) < kReturn * camera.image_size().width;
}

// Calls visit(pixel) for pixels of the border, so many apart, the corners, and a grid inside of
// `cells` each way.
template <typename F>
void for_pixels(ImageSize size, int apart, int cells, F visit) {
  const double right = size.width - 1;
  const double bottom = size.height - 1;
  for (int u = 0; u < size.width; u += apart) {
    for (const double v : {0.0, bottom}) visit(Pixel{static_cast<double>(u), v});
  }
  for (int v = 0; v < size.height; v += apart) {
    for (const double u : {0.0, right}) visit(Pixel{u, static_cast<double>(v)});
  }
  visit(Pixel{right, bottom});
  for (int y = 1; y < cells; ++y) {
    for (int x = 1; x < cells; ++x) visit(Pixel{x * right / cells, y * bottom / cells});
  }
}

}  // namespace

Status check_monotone(const Camera& camera) {
  // What folds back does so beyond some line around the centre, which lies within the image in its
  // corners first: a look at those and at some pixels between them tells whether there is one.
  bool one = true;
  for_pixels(camera.image_size(), kApart, kFewCells,
             [&](Pixel p) { one = one && has_ray(camera, p); });
  if (one) return {};
  const Pixel center = {camera.cx(), camera.cy()};
  double farthest = 0;
  double nearest = std::numeric_limits<double>::infinity();
  Pixel where;
  for_pixels(camera.image_size(), 1, kGrid, [&](Pixel p) {
    const double r = std::hypot(p.u - center.u, p.v - center.v);
    farthest = std::max(farthest, r);
    if (r < nearest && !has_ray(camera, p)) nearest = r, where = p;
  });
  if (!std::isfinite(nearest)) return {};
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format("The distortion of the calibration ({}) folds back inside the image: from {:.0f} "
                  "px off the centre on, as at ({:.0f}, {:.0f}), pixels have no ray; the corners "
                  "are {:.0f} px off. {}",
                  camera.model(), nearest, where.u, where.v, farthest,
                  nearest > kShowsEdges * farthest
                      ? "Show the board in the corners of the image."
                      : "Show the board up to the edges of the image, or take a model with fewer "
                        "coefficients; where the picture of a fisheye lens ends before the image "
                        "does, nothing is wrong."));
}

}  // namespace calvin
