// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The homographies of planes, from which several methods begin. Internal.
#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/methods/method_result.hpp"

namespace calvin {

struct PlaneViews {
  std::vector<Eigen::Matrix3d> homographies;  // view_homography() of the points in their plane
  std::vector<SE3> plane_from_board;          // none but 1 where the points have z = 0
};

// kDegenerate for a view of points in space, or one without a homography; `method` is who says so.
[[nodiscard]] Result<PlaneViews> plane_views(const MethodInput& input, std::string_view method);

// K of the plane one image width before the camera, whose axis meets the centre of the image, as
// that of px.
[[nodiscard]] Eigen::Matrix3d in_pixels(const Eigen::Matrix3d& k, ImageSize size);

}  // namespace calvin
