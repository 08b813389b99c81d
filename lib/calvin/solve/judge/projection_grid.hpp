// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The change of projections all over the image per change of a camera's parameters, the best common
// rotation of the camera taken out. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"

namespace calvin {

// The column of skew; other parameters have columns in the model's order.
inline constexpr int kSkewColumn = -1;

// The columns of the estimated parameters, in the order of the calibration. Absent where a
// parameter is of another model.
[[nodiscard]] std::optional<std::vector<int>> estimated_columns(const Calibration& calibration);

// At each pixel of a grid of 33x25 that reaches the border of the image, for a point at infinity:
// the derivative of its projection (px, 2 rows) by the parameters `columns`, less what the best
// rotation common to all pixels explains. Pixels that no ray leads to are left out. Empty where
// fewer than three are left.
using ProjectionGrid = std::vector<Eigen::Matrix<double, 2, Eigen::Dynamic>>;
[[nodiscard]] ProjectionGrid projection_grid(const Camera& camera, const std::vector<int>& columns);

// The derivatives of projections, px, at some places, less what a rotation explains: of u and of v,
// a row for each place, a column for each parameter.
struct PlacedGrid {
  std::vector<Pixel> at;
  Eigen::MatrixXd u;
  Eigen::MatrixXd v;
};

// The grid of projection_grid() all over the picture, and the part of it within the convex polygon
// `covered` with the corners of that, each with the rotation that suits its own places best.
// Without a polygon, or where there is no ray to it, the two are the same.
struct ProjectionGrids {
  PlacedGrid picture;
  PlacedGrid covered;
};
[[nodiscard]] ProjectionGrids projection_grids(const Camera& camera,
                                               const std::vector<int>& columns,
                                               const std::vector<Pixel>& covered);

// The covariance of a projection, px^2, at each place of a grid.
struct PlacedVariances {
  Eigen::VectorXd uu;
  Eigen::VectorXd uv;
  Eigen::VectorXd vv;

  // The variance at a place, in the direction of a unit vector and in that of the largest.
  [[nodiscard]] double along(Eigen::Index place, const Eigen::Vector2d& direction) const;
  [[nodiscard]] double largest(Eigen::Index place) const;
};
// `covariance`: of the parameters, symmetric.
[[nodiscard]] PlacedVariances variances(const PlacedGrid& grid, const Eigen::MatrixXd& covariance);

}  // namespace calvin
