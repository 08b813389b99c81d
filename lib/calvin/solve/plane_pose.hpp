// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pose of a plane from the rays of its points. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"

namespace calvin {

// camera_from_board for points with z = 0 and the unit rays that they are seen along (camera
// frame; a zero ray leaves its point out). Linear: ray x (H p) = 0 for H = [r1 r2 t], which holds
// for rays at and behind 90 degrees too; the nearest rotation. Absent for fewer than 4 rays, and
// where points or rays lie on one line.
[[nodiscard]] std::optional<SE3> pose_from_rays(const std::vector<Eigen::Vector3d>& points,
                                                const std::vector<Eigen::Vector3d>& rays);

// The pose whose board is tilted to the other side of the line of sight to the point `center`
// (board frame): the neighbourhood of the second minimum of the reprojection error.
[[nodiscard]] SE3 mirrored_tilt(const SE3& camera_from_board, const Eigen::Vector3d& center);

}  // namespace calvin
