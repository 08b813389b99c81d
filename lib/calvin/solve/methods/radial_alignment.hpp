// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The linear part of Tsai's method. Internal.
#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// A camera as Tsai's method has it. Ideal points of the image, px from the centre, are those that
// are seen times 1 + kappa r^2, r px from the centre; along u the image is `sx` times as wide as
// along v. Of a sensor whose pitch is known px are so many pitches.
struct TsaiCamera {
  double focal = 0;  // px
  double kappa = 0;  // 1/px^2
  double sx = 1;
  Pixel center;
  SE3 camera_from_board;

  // Where a point of the board frame is seen, px; where no radius is seen as far out as it should
  // be, at the largest one.
  [[nodiscard]] Pixel project(const Eigen::Vector3d& point) const;
};

// The radius, px, that is seen where the ideal one is `ideal`: the inverse of r (1 + kappa r^2), as
// far as that grows.
[[nodiscard]] double seen_radius(double ideal, double kappa);

// A point in use: in the board frame, m, and in the image, px from the centre.
struct CenteredPoint {
  Eigen::Vector3d board;
  Eigen::Vector2d image;
};
[[nodiscard]] std::vector<CenteredPoint> centered_points(const PointSet& view,
                                                         const SE3& frame_from_board, Pixel center);

// Only the directions of the points from `center` give rotation, tx and ty, so that radial
// distortion does not matter; focal length and tz are linear with kappa = 0 (R. Y. Tsai, A
// Versatile Camera Calibration Technique for High-Accuracy 3D Machine Vision Metrology Using
// Off-the-Shelf TV Cameras and Lenses, IEEE J. Robotics and Automation RA-3(4), 1987, stage 1 and
// equation 15). Of points in a plane (at least 5, sx is 1) or in space (at least 7). kDegenerate
// where they do not determine the camera, as those of a plane seen head-on: the message says what
// to do.
[[nodiscard]] Result<TsaiCamera> radial_alignment(const PointSet& view, Pixel center);

// kDegenerate: why Tsai's method finds no camera.
[[nodiscard]] tl::unexpected<Error> no_tsai_camera(std::string_view why);

}  // namespace calvin
