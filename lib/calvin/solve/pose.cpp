// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checks an observation, fits its pose and measures both tilts that a plane leaves open.

#include "calvin/solve/pose.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/start/pose_fit.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

namespace {

// The root mean square distance of the corners in use, not weighted, px.
double rms_of(const PointSet& view, const Camera& camera, const SE3& camera_from_board) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    const auto at = camera.project(camera_from_board * view.points[i]);
    if (!at) continue;
    const double du = at->u - view.uv[i].u;
    const double dv = at->v - view.uv[i].v;
    sum += du * du + dv * dv;
    count += 1;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

Result<SE3> solve_pose(const Camera& camera, const Board& board, const Observation& observation,
                       PoseQuality* quality, const BoardWarp& warp) {
  const ImageSize size = camera.image_size();
  if (observation.image_size.width > 0 && observation.image_size != size) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The board was seen in an image of {}x{} px, the camera's is {}x{}. "
                    "Scale the camera to the image first.",
                    observation.image_size.width, observation.image_size.height, size.width,
                    size.height));
  }
  if (const Status status = check({observation, board}, size); !status) {
    return tl::unexpected<Error>(status.error());
  }
  std::vector<PointSet> view = {to_points(board, bent_points(board, warp), observation)};
  (void)normalise_weights(view);
  const auto rays = rays_of(view[0], camera);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].isZero()) view[0].weight[i] = 0;
  }
  std::optional<PoseFit> fit;
  if (spans_plane(view[0])) fit = fit_pose(view[0], camera, Loss{});
  if (!fit) {
    return make_error(
        ErrorCode::kDegenerate,
        "The corners do not determine the pose of the board: at least 4 that the camera "
        "can see and that do not lie on one line are needed.");
  }
  if (quality != nullptr) {
    const double rms = rms_of(view[0], camera, fit->camera_from_board);
    *quality = {rms, std::max(rms, rms_of(view[0], camera, fit->other))};
  }
  return fit->camera_from_board;
}

}  // namespace calvin
