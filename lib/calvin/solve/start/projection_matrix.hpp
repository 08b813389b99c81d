// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The projection matrix of points in space by the direct linear transformation. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"

namespace calvin {

using ProjectionMatrix = Eigen::Matrix<double, 3, 4>;

// The P with P (x, y, z, 1) along the ray of each point, up to scale, the points ahead: linear,
// from ray x (P X) = 0 (Y. I. Abdel-Aziz, H. M. Karara, Direct Linear Transformation from
// Comparator Coordinates into Object Space Coordinates, 1971), in normalised coordinates, which
// make its normal equations well conditioned (R. I. Hartley, PAMI 19(6), 1997). Rays are unit
// vectors; a zero ray leaves its point out. Where some rays are far off the rest, reweighted by
// Cauchy's function of their angle until they no longer count. Absent for fewer than 6 rays, and
// where more matrices than one fit, as of points in a plane.
[[nodiscard]] std::optional<ProjectionMatrix> projection_matrix(
    const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& rays);

// P = K [R | t] up to scale.
struct DecomposedProjection {
  Eigen::Matrix3d k;  // upper triangular, its last entry 1, its diagonal positive
  SE3 camera_from_board;
};

// By the RQ decomposition of the left 3x3 block. Absent where that is singular or mirrors, as where
// the points are given in a left-handed frame.
[[nodiscard]] std::optional<DecomposedProjection> decompose(const ProjectionMatrix& p);

// camera_from_board of a camera whose rays are known: the rigid motion near the projection matrix.
// Absent where there is no such matrix, or it mirrors.
[[nodiscard]] std::optional<SE3> pose_in_space(const std::vector<Eigen::Vector3d>& points,
                                               const std::vector<Eigen::Vector3d>& rays);

}  // namespace calvin
