// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Planes before a lens whose focal length nobody knows: a homography for each, and the centre and
// the radial factor of the distortion that they have in common. Internal.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// With q the ideal place of a point, in units of `width` px from the centre c, and s = |q|^2,
//
//   q ~ H (x, y, 1)      seen = c + width q (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6
//   s^3)
//
// The numerator has `terms` coefficients, the denominator as many or none.
struct RadialModel {
  int terms = 3;
  bool rational = false;
  bool centered = false;  // c is the centre of the image

  [[nodiscard]] int count() const noexcept { return rational ? 2 * terms : terms; }
};

// The coefficients by which a radius of `ideal` is seen at `seen`, both in units of the width, for
// all radii given: linear least squares, with the denominator on the other side.
struct SeenRadius {
  double seen = 0;
  double ideal = 0;
};
struct RadialFit {
  std::vector<double> k;
  double residual = 0;  // the largest difference of a seen radius
};
[[nodiscard]] RadialFit fit_radii(std::span<const SeenRadius> radii, const RadialModel& model);

struct RadialPlanes {
  Pixel center;  // px
  std::vector<double> k;
  std::vector<Eigen::Matrix3d> homographies;  // of each view
  // Of the centre, px, where it was estimated, and k.
  Eigen::MatrixXd covariance;
  // Views and corners of them that were left out as outliers.
  std::vector<std::pair<std::size_t, std::size_t>> left_out;
};

// Least squares on the distances of points from where they are seen, weighted as the views say; the
// covariance is scaled by what is left. `start`: homographies of the planes z = 0 of the views, in
// units of `size.width` from the centre of the image. kDegenerate where points are too few, or
// where the distortion is too weak to tell its centre.
[[nodiscard]] Result<RadialPlanes> fit_radial_planes(std::span<const PointSet> views,
                                                     std::span<const Eigen::Matrix3d> start,
                                                     ImageSize size, const RadialModel& model,
                                                     bool reject_outliers);

}  // namespace calvin
