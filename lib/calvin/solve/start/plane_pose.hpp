// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pose of a plane from the rays of its points. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"

namespace calvin {

// The H = [h1 h2 h3] with H (x, y, 1) along the ray of each point (x, y, 0): the homography of a
// plane, up to scale, the points ahead. Linear, from ray x (H p) = 0, which holds for rays at and
// behind 90 degrees too. Where some rays are far off the rest, reweighted by Cauchy's function of
// their angle until they no longer count. Rays are unit vectors in the camera frame; a zero ray
// leaves its point out. Absent for fewer than 4 rays, and where points or rays lie on one line.
[[nodiscard]] std::optional<Eigen::Matrix3d> plane_homography(
    const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& rays);

// camera_from_board: the rigid motion near a plane_homography(), whose first two columns are turned
// towards or from each other by equal angles until they are at right angles. Absent for a singular
// homography.
[[nodiscard]] std::optional<SE3> pose_from_homography(const Eigen::Matrix3d& h);
[[nodiscard]] std::optional<SE3> pose_from_rays(const std::vector<Eigen::Vector3d>& points,
                                                const std::vector<Eigen::Vector3d>& rays);

// The pose whose board is tilted to the other side of the line of sight to the point `center`: the
// neighbourhood of the second minimum of the reprojection error. `normal`: of the board's plane, of
// length 1. Both in the board frame.
[[nodiscard]] SE3 mirrored_tilt(const SE3& camera_from_board, const Eigen::Vector3d& center,
                                const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ());

}  // namespace calvin
