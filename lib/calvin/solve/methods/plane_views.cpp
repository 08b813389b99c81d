// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Points in their own plane, and the homographies of views.

#include "calvin/solve/methods/plane_views.hpp"

#include <fmt/format.h>

#include "calvin/solve/start/camera_guess.hpp"

namespace calvin {

Result<PlaneViews> plane_views(const MethodInput& input, std::string_view method) {
  PlaneViews planes;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    const PointSet& view = input.views[v];
    if (spans_space(view)) {
      return make_error(
          ErrorCode::kDegenerate,
          fmt::format("{} takes points in a plane, and those of view {} lie in space: take the "
                      "method dlt or tsai.",
                      method, v));
    }
    const auto plane = board_from_plane(view);
    planes.plane_from_board.push_back(plane ? plane->inverse() : SE3{});
    PointSet flat = view;
    for (Eigen::Vector3d& p : flat.points) p = planes.plane_from_board.back() * p;
    const auto h = view_homography(flat, input.size);
    if (!h) {
      return make_error(ErrorCode::kDegenerate,
                        fmt::format("{} finds no camera: the points of view {} determine no "
                                    "homography, as where they lie on a line.",
                                    method, v));
    }
    planes.homographies.push_back(*h);
  }
  return planes;
}

Eigen::Matrix3d in_pixels(const Eigen::Matrix3d& k, ImageSize size) {
  const Pixel center = image_center(size);
  Eigen::Matrix3d px = k;
  px.topRows<2>() *= size.width;
  px(0, 2) += center.u;
  px(1, 2) += center.v;
  return px;
}

}  // namespace calvin
