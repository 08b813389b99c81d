// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A pose by least squares, and whether all views agree on it.

#include "calvin/rig/floor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "calvin/rig/joint/pose_covariance.hpp"
#include "calvin/solve/start/pose_fit.hpp"

namespace calvin::rig {

namespace {

PointSet all_of(const std::vector<BoardView>& views) {
  PointSet all = views.front().seen.without_corners();
  for (const BoardView& view : views) {
    for (std::size_t i = 0; i < view.seen.size(); ++i) all.append(view.seen, i);
  }
  all.motion.clear();
  return all;
}

double rms_of(const PointSet& seen, const Camera& camera, const SE3& pose) {
  double squares = 0;
  double corners = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto at = camera.project(pose * seen.points[i]);
    if (!at || !(seen.weight[i] > 0)) continue;
    squares += std::pow(at->u - seen.uv[i].u, 2) + std::pow(at->v - seen.uv[i].v, 2);
    corners += 1;
  }
  return corners > 0 ? std::sqrt(squares / corners) : 0;
}

// Whether a view by itself fits far better than with the others.
bool has_moved(const std::vector<BoardView>& views, const Camera& camera, const SE3& pose) {
  constexpr double kFar = 5;    // times its own misfit
  constexpr double kLeast = 1;  // px, weighted
  const CameraPoints points(camera);
  return std::ranges::any_of(views, [&](const BoardView& view) {
    const double own = misfit(view, points, view.poses.front(), SE3());
    const double with_others = misfit(view, points, pose, SE3());
    return with_others > kLeast && with_others > kFar * own;
  });
}

// Where a camera that sees the board nearly head-on, or small, stands is known least: its distance,
// and with it the way that it looks.
std::optional<std::string> uncertain_place(const FloorPose& pose, const std::string& name) {
  constexpr double kMuch = 0.01;  // of the distance
  constexpr double kMillimetre = 1e-3;
  constexpr double kDegree = std::numbers::pi / 180;
  const double distance = pose.camera_from_board.translation.norm();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
      pose.covariance.bottomRightCorner<3, 3>(), Eigen::EigenvaluesOnly);
  const double sigma = std::sqrt(std::max(axes.eigenvalues()(2), 0.0));
  if (sigma <= kMuch * distance) return std::nullopt;
  const Eigen::Vector3d line_of_sight = pose.camera_from_board.translation / distance;
  const double tilt = std::acos(
      std::clamp(std::abs(pose.camera_from_board.rotation.col(2).dot(line_of_sight)), 0.0, 1.0));
  return fmt::format(
      "Where the camera '{}' stands is known to {:.1f} mm only (1 sigma): it sees the board at "
      "{:.0f} "
      "degrees from head-on, {:.0f} mm away. Tilt the board by 30 to 45 degrees before it, or show "
      "it larger.",
      name, sigma / kMillimetre, tilt / kDegree, distance / kMillimetre);
}

}  // namespace

Result<FloorPose> floor_pose(const std::vector<BoardView>& views, const Calibration& calibration,
                             const Camera& camera) {
  const PointSet seen = all_of(views);
  const auto fit = fit_pose(seen, camera, Loss{});
  if (!fit || has_moved(views, camera, fit->camera_from_board)) {
    return make_error(
        ErrorCode::kDegenerate,
        fmt::format("The camera '{}' has seen the board in several places: as the floor of a rig "
                    "it has to lie still. Show it to all cameras without moving it, or solve "
                    "jointly.",
                    calibration.camera));
  }
  FloorPose pose;
  pose.camera_from_board = fit->camera_from_board;
  pose.rms = rms_of(seen, camera, pose.camera_from_board);
  pose.has_two_tilts =
      std::ranges::all_of(views, [](const BoardView& view) { return view.poses.size() > 1; });
  const double free = std::max(2 * static_cast<double>(seen.used()) - 6, 1.0);
  const PoseCovariance covariance =
      pose_covariance(seen, calibration, camera, pose.camera_from_board, fit->cost / free);
  pose.covariance = covariance.of_noise + covariance.of_lens;
  return pose;
}

std::vector<std::string> floor_remarks(const FloorPose& pose, const std::string& name) {
  std::vector<std::string> remarks;
  if (auto remark = uncertain_place(pose, name)) remarks.push_back(*std::move(remark));
  if (pose.has_two_tilts) {
    remarks.push_back(fmt::format(
        "The camera '{}' sees the board so flat or so small that the mirrored tilt fits nearly as "
        "well: show it larger, or tilted.",
        name));
  }
  return remarks;
}

}  // namespace calvin::rig
