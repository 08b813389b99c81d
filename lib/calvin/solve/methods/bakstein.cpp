// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Planes in the frame of the camera, and the projection matrix of all of them, in turns.

#include "calvin/solve/methods/bakstein.hpp"

#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/solve/methods/plane_views.hpp"
#include "calvin/solve/start/camera_guess.hpp"
#include "calvin/solve/start/plane_pose.hpp"
#include "calvin/solve/start/projection_matrix.hpp"

namespace calvin {

namespace {

tl::unexpected<Error> no_bakstein_camera(std::string why) {
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("Bakstein's method finds no camera: {}.", why));
}

// The first camera, of the plane one image width before it.
Eigen::Matrix3d first_camera(const PlaneViews& planes, ImageSize size) {
  const auto guesses = closed_form_guesses(planes.homographies, size);
  // The last one is the median over the views, with the principal point at the centre.
  const double focal = guesses.empty() ? 1 : guesses.back()[0] / size.width;
  return Eigen::Vector3d(focal, focal, 1).asDiagonal();
}

// camera_from_plane of all views; absent where one has none.
std::optional<std::vector<SE3>> poses_of(const PlaneViews& planes, const Eigen::Matrix3d& k) {
  std::vector<SE3> poses;
  for (const Eigen::Matrix3d& h : planes.homographies) {
    const auto pose = pose_from_homography(k.inverse() * h);
    if (!pose) return std::nullopt;
    poses.push_back(*pose);
  }
  return poses;
}

// The camera that sees the virtual object.
std::optional<Eigen::Matrix3d> camera_of(const MethodInput& input, const PlaneViews& planes,
                                         const std::vector<SE3>& poses) {
  std::vector<Eigen::Vector3d> object;
  std::vector<Eigen::Vector3d> rays;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    const SE3 camera_from_board = poses[v] * planes.plane_from_board[v];
    const auto seen = unit_rays(input.views[v], input.size);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!(input.views[v].weight[i] > 0)) continue;
      object.push_back(camera_from_board * input.views[v].points[i]);
      rays.push_back(seen[i]);
    }
  }
  const auto p = projection_matrix(object, rays);
  const auto camera = p ? decompose(*p) : std::nullopt;
  if (!camera) return std::nullopt;
  return camera->k;
}

// A camera with the planes of all views before it, and the mean square of the distances of the
// points from where they are seen, image widths squared.
struct Turn {
  Eigen::Matrix3d k;
  std::vector<SE3> poses;
  double error = 0;
};

std::optional<Turn> turn_of(const MethodInput& input, const PlaneViews& planes,
                            const Eigen::Matrix3d& k) {
  auto poses = poses_of(planes, k);
  if (!poses) return std::nullopt;
  Turn turn = {k, *std::move(poses), 0};
  double count = 0;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    const PointSet& view = input.views[v];
    const auto seen = unit_rays(view, input.size);
    const SE3 camera_from_board = turn.poses[v] * planes.plane_from_board[v];
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (!(view.weight[i] > 0)) continue;
      const Eigen::Vector3d at = k * (camera_from_board * view.points[i]);
      turn.error += (at.hnormalized() - seen[i].hnormalized()).squaredNorm();
      count += 1;
    }
  }
  turn.error /= count;
  return turn;
}

}  // namespace

// The turns are no descent: past the best camera they may drift to one that puts the object off the
// axis. They end where the points no longer come nearer to where they are seen.
Result<MethodResult> bakstein_method(const MethodInput& input) {
  constexpr int kMostTurns = 500;
  constexpr double kLess = 1e-6;  // of the error
  const auto planes = plane_views(input, "Bakstein's method");
  if (!planes) return tl::unexpected<Error>(planes.error());
  if (input.views.size() < 2) return no_bakstein_camera("it takes two views of a plane and more");
  auto best = turn_of(input, *planes, first_camera(*planes, input.size));
  if (!best)
    return no_bakstein_camera("a view has no pose before a camera that looks through its centre");
  for (int i = 0; i < kMostTurns; ++i) {
    const auto k = camera_of(input, *planes, best->poses);
    auto next = k ? turn_of(input, *planes, *k) : std::nullopt;
    if (!next || !(next->error < (1 - kLess) * best->error)) break;
    best = std::move(next);
  }
  for (std::size_t v = 0; v < best->poses.size(); ++v) {
    best->poses[v] = best->poses[v] * planes->plane_from_board[v];
  }
  const Eigen::Matrix3d px = in_pixels(best->k, input.size);
  auto camera = Camera::make("pinhole", input.size, {px(0, 0), px(1, 1), px(0, 2), px(1, 2)},
                             input.skew ? px(0, 1) : 0);
  if (!camera) return tl::unexpected<Error>(camera.error());
  return MethodResult{*std::move(camera), std::move(best->poses), {}, {}};
}

}  // namespace calvin
