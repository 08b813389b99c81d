// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pixels and their rays, and how projections along these change with the camera, all at once.
// Internal.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/residuals/view_points.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

// Pixels that have a ray.
struct PixelRays {
  std::vector<Pixel> at;
  std::vector<Eigen::Vector3d> rays;  // of any length
};

// Those of some pixels, each by itself.
[[nodiscard]] PixelRays rays_at(const Camera& camera, const std::vector<Pixel>& pixels);

// Those of a grid that reaches the border of the image, row after row. Columns and rows are
// multiples of 4 and one more. Every fourth ray is found by itself; those between start from these.
[[nodiscard]] PixelRays grid_rays(const Camera& camera, int columns, int rows);

// The rows of the projections along a few rays: columns as in RowLayout, where the pose is that of
// the camera. The skew has a column.
class RayRows {
 public:
  static constexpr std::size_t kMost = 64;  // rays at once, which stay in the nearest cache

  // The camera must outlive this.
  explicit RayRows(const Camera& camera);

  // At least one.
  void take(std::span<const Eigen::Vector3d> rays);
  // False where a ray has no projection.
  [[nodiscard]] bool fill();
  // Moves the rays to those of their pixels, of which there are as many. False where they do not
  // come there.
  [[nodiscard]] bool settle(std::span<const Pixel> pixels);

  [[nodiscard]] Eigen::Vector3d ray(std::size_t i);
  [[nodiscard]] ViewRows& rows() { return rows_; }

 private:
  const Camera& camera_;
  FillRows fill_;
  ViewPoints points_;
  ViewRows rows_;
};

}  // namespace calvin
