// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How much of its picture a camera covers, over cells of solid angle, and how much of it a board.

#include "calvin/camera/usable_area.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/convex_hull.hpp"

namespace calvin {

namespace {

constexpr int kColumns = 32;  // of cells
constexpr int kRows = 24;

using Ray = std::optional<Eigen::Vector3d>;

// The rays of one row of the corners of the cells, of which the first is row 0.
std::vector<Ray> rays_of(const Camera& camera, int row) {
  const ImageSize size = camera.image_size();
  std::vector<Ray> rays;
  for (int column = 0; column <= kColumns; ++column) {
    rays.push_back(
        camera.unproject({coordinate_at(static_cast<double>(column) / kColumns, size.width),
                          coordinate_at(static_cast<double>(row) / kRows, size.height)}));
  }
  return rays;
}

// Of what lies between four rays, in the order around it: half the cross product of the diagonals.
double solid_angle(const Ray& a, const Ray& b, const Ray& c, const Ray& d) {
  if (!a || !b || !c || !d) return 0;
  return (*c - *a).cross(*d - *b).norm() / 2;
}

constexpr double kLeast = 0.2;

// How many times that way leads from a pixel in the picture to its border.
double to_border(ImageSize size, Pixel from, Pixel way) {
  const auto along = [](double at, double step, int count) {
    return std::abs(((step < 0 ? 0 : count) - 0.5 - at) / step);
  };
  return std::min(along(from.u, way.u, size.width), along(from.v, way.v, size.height));
}

}  // namespace

double usable_area(const Camera& camera) {
  double sum = 0;
  double squares = 0;
  std::vector<Ray> above = rays_of(camera, 0);
  for (int row = 1; row <= kRows; ++row) {
    std::vector<Ray> below = rays_of(camera, row);
    for (std::size_t i = 0; i < kColumns; ++i) {
      const double w = solid_angle(above[i], above[i + 1], below[i + 1], below[i]);
      sum += w;
      squares += w * w;
    }
    above = std::move(below);
  }
  return squares > 0 ? sum * sum / (kColumns * kRows * squares) : 0;
}

double visible_area(const Camera& camera) {
  constexpr double kGrazing = 85.0 / 180 * std::numbers::pi;  // rad
  constexpr int kDirections = 360;
  const ImageSize size = camera.image_size();
  const auto axis = camera.project({0, 0, 1});
  const bool is_inside =
      axis && axis->u > 0 && axis->v > 0 && axis->u < size.width - 1 && axis->v < size.height - 1;
  if (!is_inside) return 1.0 * size.width * size.height;
  std::vector<Pixel> border;
  for (int i = 0; i < kDirections; ++i) {
    const double x = std::cos(2 * std::numbers::pi * i / kDirections);
    const double y = std::sin(2 * std::numbers::pi * i / kDirections);
    const double radius = std::sin(kGrazing);
    const auto at = camera.project({radius * x, radius * y, std::cos(kGrazing)});
    const Pixel way =
        at ? Pixel{at->u - axis->u, at->v - axis->v} : Pixel{camera.fx() * x, camera.fy() * y};
    const double most = to_border(size, *axis, way);
    const double part = at ? std::min(1.0, most) : most;
    border.push_back({axis->u + part * way.u, axis->v + part * way.v});
  }
  return polygon_area(border);
}

Status check_usable_area(const Camera& camera) {
  const double area = usable_area(camera);
  if (area >= kLeast) return {};
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format("The calibration covers only {:.1f} % of its picture of {}x{} px: to the rest "
                  "leads no ray, or all rays are nearly one. Check fx, fy and the distortion "
                  "coefficients for a wrong unit or sign, and the image size; or calibrate again.",
                  100 * area, camera.image_size().width, camera.image_size().height));
}

}  // namespace calvin
