// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Projection matrices of views, taken apart and averaged.

#include "calvin/solve/methods/dlt.hpp"

#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/solve/methods/plane_views.hpp"
#include "calvin/solve/start/camera_guess.hpp"

namespace calvin {

namespace {

tl::unexpected<Error> refused(std::size_t view, std::string_view why) {
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format("The direct linear transformation finds no camera: view {} {}.", view, why));
}

}  // namespace

Result<DecomposedProjection> dlt_of_view(const PointSet& view, std::size_t number, ImageSize size) {
  if (!spans_space(view)) {
    return refused(number,
                   "shows too few points, or points that lie in a plane; it takes 6 in space (the "
                   "methods zhang and tsai take planes)");
  }
  const auto p = projection_matrix(view.points, unit_rays(view, size));
  if (!p) return refused(number, "leaves more cameras than one: give points out of its plane");
  auto camera = decompose(*p);
  if (!camera) {
    return refused(number,
                   "comes out mirrored: the frame of its points is left-handed (turn one axis "
                   "round, as -Z), or the picture is mirrored");
  }
  camera->k = in_pixels(camera->k, size);
  return *camera;
}

Result<MethodResult> dlt_method(const MethodInput& input) {
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  std::vector<SE3> poses;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    const auto camera = dlt_of_view(input.views[i], i, input.size);
    if (!camera) return tl::unexpected<Error>(camera.error());
    mean += camera->k / static_cast<double>(input.views.size());
    poses.push_back(camera->camera_from_board);
  }
  auto camera =
      Camera::make("pinhole", input.size, {mean(0, 0), mean(1, 1), mean(0, 2), mean(1, 2)},
                   input.skew ? mean(0, 1) : 0);
  if (!camera) return tl::unexpected<Error>(camera.error());
  return MethodResult{*std::move(camera), std::move(poses), {}, {}};
}

}  // namespace calvin
