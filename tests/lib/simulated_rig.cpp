// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where cameras of a rig stand and a board is held, what they see of it, and how far a solved
// camera is from its place.

#include "simulated_rig.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "calvin/geometry/dense.hpp"

namespace calvin::scenes {

SE3 looking(const Eigen::Vector3d& from, const Eigen::Vector3d& at) {
  const Eigen::Vector3d forward = (at - from).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(forward).normalized() * -1;
  Eigen::Matrix3d rotation;
  rotation << -right, forward.cross(-right), forward;
  return {rotation, from};
}

SimulatedRig stereo_rig(Random& random) {
  SimulatedRig rig;
  rig.cameras = {random_camera("brown5", random), random_camera("brown5", random)};
  rig.world_from_camera = {SE3(), {exp_so3({0.02, -0.05, 0.01}), {0.12, 0.003, -0.002}}};
  rig.middle = {0.06, 0, 0.6};
  rig.reach = {0.12, 0.08, 0.2};
  return rig;
}

SimulatedRig ring_rig(int count, Random& random) {
  SimulatedRig rig;
  for (int i = 0; i < count; ++i) {
    const ImageSize size = i % 2 == 0 ? kSize : ImageSize{800, 600};
    rig.cameras.push_back(random_camera(i % 3 == 2 ? "fisheye" : "brown5", random, size));
    const double angle = 2 * std::numbers::pi * i / count;
    rig.world_from_camera.push_back(looking(
        {0.9 * std::cos(angle), 0.9 * std::sin(angle), i % 2 == 0 ? -0.35 : -0.15}, {0, 0, 0}));
  }
  rig.reach = {0.12, 0.12, 0.08};
  return rig;
}

SimulatedRig chain_rig(int count, Random& random) {
  SimulatedRig rig;
  for (int i = 0; i < count; ++i) {
    rig.cameras.push_back(random_camera("brown5", random));
    rig.world_from_camera.push_back({exp_so3({0.01 * i, 0.02, -0.01 * i}), {0.35 * i, 0, 0}});
  }
  rig.middle = {0.175 * (count - 1), 0, 0.7};
  rig.reach = {0.175 * (count - 1) + 0.15, 0.08, 0.12};
  return rig;
}

SE3 held_board(const SimulatedRig& rig, double tilt, Random& random) {
  const Eigen::Vector3d at =
      rig.middle + rig.reach.cwiseProduct(Eigen::Vector3d(
                       uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)));
  std::uniform_int_distribution<std::size_t> any(0, rig.cameras.size() - 1);
  const SE3& towards = rig.world_from_camera[any(random)];
  const Eigen::Vector3d away = (at - towards.translation).normalized();
  const Eigen::Matrix3d facing = rotation_between(Eigen::Vector3d::UnitZ(), away);
  const double direction = uniform(random, 0, 2 * std::numbers::pi);
  const double angle = uniform(random, 0, tilt);
  const Eigen::Matrix3d turn =
      exp_so3({angle * std::cos(direction), angle * std::sin(direction), 0}) *
      exp_so3({0, 0, uniform(random, -std::numbers::pi, std::numbers::pi)});
  const BoardArea extent = rig.board.extent();
  const Eigen::Vector3d middle(extent.width() / 2, extent.height() / 2, 0);
  const Eigen::Matrix3d rotation = facing * turn;
  return {rotation, at - rotation * middle};
}

bool faces(const SE3& camera_from_board) {
  constexpr double kLeastCosine = 0.3;
  const Eigen::Vector3d away = camera_from_board.translation.normalized();
  return camera_from_board.rotation.col(2).dot(away) > kLeastCosine;
}

void name_at_random(View& view, Random& random) {
  view.observation.ambiguous = view.board.symmetries();
  if (view.observation.ambiguous.empty() || uniform(random, 0, 1) < 0.5) return;
  for (int& id : view.observation.ids) id = view.board.point_count() - 1 - id;
}

std::vector<RigCameraViews> seen_by(const SimulatedRig& rig, int instants, double tilt,
                                    Random& random) {
  std::vector<RigCameraViews> all(rig.cameras.size());
  for (std::size_t c = 0; c < all.size(); ++c) {
    all[c].calibration = rig.cameras[c].to_calibration();
    all[c].calibration.camera = "cam" + std::to_string(c);
  }
  for (int n = 0; n < instants; ++n) {
    const SE3 world_from_board = held_board(rig, tilt, random);
    for (std::size_t c = 0; c < all.size(); ++c) {
      const SE3 pose = rig.world_from_camera[c].inverse() * world_from_board;
      if (!faces(pose) || !sees_all(rig.cameras[c], rig.board, pose)) continue;
      View view = observe(rig.cameras[c], rig.board, pose, rig.noise, random);
      view.observation.timestamp = static_cast<std::uint64_t>(n) * 1'000'000'000 + c * 1'000'000;
      name_at_random(view, random);
      all[c].views.push_back(std::move(view));
    }
  }
  return all;
}

PlaceError place_error(const RigCamera& found, const SE3& truth) {
  const SE3 pose = to_se3(found.rig_from_camera);
  Eigen::Matrix<double, 6, 1> e;
  e << log_so3(pose.rotation * truth.rotation.transpose()), pose.translation - truth.translation;
  const Eigen::Map<const Eigen::Matrix<double, 6, 6>> covariance(found.covariance.data());
  PlaceError error;
  error.square = e.dot(solve_symmetric(covariance, e).col(0)) / 6;
  error.largest = e.cwiseQuotient(covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
  error.turn = e.head<3>().norm();
  error.place = e.tail<3>().norm();
  return error;
}

}  // namespace calvin::scenes
