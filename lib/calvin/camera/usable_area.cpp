// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How much of its picture a camera covers, over cells of solid angle.

#include "calvin/camera/usable_area.hpp"

#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/camera/image_transform.hpp"

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
