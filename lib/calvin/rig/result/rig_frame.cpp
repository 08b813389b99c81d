// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Places and covariances from frame to frame.

#include "calvin/rig/result/rig_frame.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/geometry/cross_matrix.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/rig/pose_unknowns.hpp"

namespace calvin::rig {

namespace {

Eigen::Index at(std::size_t frame) { return kPose * static_cast<Eigen::Index>(frame); }

// Exact for quarter turns.
Eigen::Matrix3d rotation_of(const std::vector<RigWorld::Turn>& turns) {
  Eigen::Matrix3d all = Eigen::Matrix3d::Identity();
  for (const RigWorld::Turn& turn : turns) {
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();
    axis(turn.axis) = turn.quarters * std::numbers::pi / 2;
    all *= exp_so3(axis).array().round().matrix();
  }
  return all;
}

}  // namespace

// For R = exp(d) R0 and t = exp(d) t0 + e a camera stands at -R^T t, so that both its turn in the
// rig and its place move by -R0^T of d and e; what is at t0 itself moves by d x t0 + e.
PlacedCameras frames_of(const RigFit& fit) {
  const std::vector<SE3>& camera_from_rig = fit.places.camera_from_rig;
  const std::size_t cameras = camera_from_rig.size();
  const std::size_t count = cameras + (fit.board ? 1 : 0);
  PlacedCameras frames;
  for (const SE3& pose : camera_from_rig) frames.rig_from_camera.push_back(pose.inverse());
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(at(count), at(count - 1));
  for (std::size_t c = 1; c < cameras; ++c) {
    const Eigen::Matrix3d back = -camera_from_rig[c].rotation.transpose();
    moves.block<3, 3>(at(c), at(c - 1)) = back;
    moves.block<3, 3>(at(c) + 3, at(c - 1) + 3) = back;
  }
  if (!fit.board) {
    frames.covariance = congruent(fit.covariance, moves.transpose());
    return frames;
  }
  const SE3& board = fit.board->rig_from_board;
  frames.rig_from_camera.push_back(board);
  moves.block<kPose, kPose>(at(cameras), at(cameras - 1)).setIdentity();
  moves.block<3, 3>(at(cameras) + 3, at(cameras - 1)) = -cross_matrix(board.translation);
  frames.covariance = congruent(with_board(fit.covariance, *fit.board), moves.transpose());
  return frames;
}

void add_own_frame(PlacedCameras& frames) {
  const Eigen::Index before = at(frames.rig_from_camera.size());
  frames.rig_from_camera.emplace_back();
  frames.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(before + kPose, before + kPose));
}

Status check_world(const RigWorld& world, const std::vector<std::string>& names) {
  for (const RigWorld::Turn& turn : world.turns) {
    if (turn.axis >= 0 && turn.axis <= 2) continue;
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The frame of the rig cannot be turned about axis {}: give 0 for "
                                  "x, 1 for y or 2 for z.",
                                  turn.axis));
  }
  if (world.time && std::isnan(*world.time)) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The time of the board that is the frame of the rig is no number: give "
                      "seconds, or infinity for the last one.");
  }
  if (world.camera.empty() || std::ranges::find(names, world.camera) != names.end()) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("The frame of the rig is to be that of '{}', which is none of its "
                                "cameras: these are '{}'. That of a board is called '{}'.",
                                shortened(world.camera, 64), join(names, "', '"), kBoardWorld));
}

std::string drop_world(std::optional<RigWorld>& world) {
  const RigWorld dropped = *std::exchange(world, std::nullopt);
  return fmt::format("The frame is not that of '{}', which is not in the rig.", dropped.camera);
}

// With errors a and p of the turn and place of a frame, and b and q of those of the world, in the
// rig, the frame is turned by R^T (a - b) in the world and stands R^T (p - q - b x (t - w)) off.
SE3 set_world(const RigWorld& world, const std::vector<std::string>& names, PlacedCameras& frames) {
  const auto named =
      static_cast<std::size_t>(std::ranges::find(names, world.camera) - names.begin());
  const std::size_t chosen = world.camera.empty() ? names.size() : named;
  SE3 rig_from_world = frames.rig_from_camera[chosen];
  rig_from_world.rotation = rig_from_world.rotation * rotation_of(world.turns);
  const Eigen::Matrix3d back = rig_from_world.rotation.transpose();
  const std::size_t count = frames.rig_from_camera.size();
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(at(count), at(count));
  for (std::size_t f = 0; f < count; ++f) {
    const Eigen::Vector3d away = frames.rig_from_camera[f].translation - rig_from_world.translation;
    moves.block<3, 3>(at(f), at(f)) += back;
    moves.block<3, 3>(at(f) + 3, at(f) + 3) += back;
    moves.block<3, 3>(at(f), at(chosen)) -= back;
    moves.block<3, 3>(at(f) + 3, at(chosen) + 3) -= back;
    moves.block<3, 3>(at(f) + 3, at(chosen)) += back * cross_matrix(away);
  }
  const SE3 world_from_rig = rig_from_world.inverse();
  for (SE3& frame : frames.rig_from_camera) frame = world_from_rig * frame;
  frames.covariance = congruent(frames.covariance, moves.transpose());
  return world_from_rig;
}

void move_boards(const SE3& world_from_rig, std::vector<RigBoard>& boards) {
  for (RigBoard& board : boards) {
    board.rig_from_board = to_pose(world_from_rig * to_se3(board.rig_from_board));
  }
}

}  // namespace calvin::rig
