// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Numbers of a fit as HandEye has them, and remarks.

#include "calvin/rig/hand_eye/report.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin::rig {

namespace {

constexpr double kMillimetre = 1e-3;  // m

void set_loop_rms(const std::vector<LoopError>& loops, HandEye& to) {
  double turn = 0;
  double place = 0;
  for (const LoopError& loop : loops) {
    if (!loop.used) continue;
    ++to.poses;
    for (std::size_t k = 0; k < 3; ++k) {
      turn += loop.turn[k] * loop.turn[k];
      place += loop.place[k] * loop.place[k];
    }
  }
  to.loop_turn = std::sqrt(turn / std::max(to.poses, 1));
  to.loop_place = std::sqrt(place / std::max(to.poses, 1));
}

// A length of the board that can be measured: the way from a corner to the next.
void remark_scale(const HandEye& found, const Board& board, bool free_scale,
                  std::vector<std::string>& remarks) {
  constexpr double kSignificant = 3;  // sigmas
  if (!found.scale) return;
  const auto& [value, sigma] = *found.scale;
  if (!(std::abs(value - 1) > kSignificant * sigma)) return;
  const auto grid = board.grid();
  const double pitch = grid ? grid->pitch : board.extent().width();
  std::string text = fmt::format(
      "By the robot's lengths the {} of the board measures {:.5g} mm (+-{:.2g}), not {:.5g} mm.",
      grid ? "pitch" : "width", value * pitch / kMillimetre, sigma * pitch / kMillimetre,
      pitch / kMillimetre);
  text += free_scale ? " The places are in the robot's lengths."
                     : " Measure the board and give its size; if it is right, the robot's lengths "
                       "are wrong.";
  remarks.push_back(std::move(text));
}

// The place of the camera is far less well known in one direction than in the others.
void remark_direction(const Eigen::MatrixXd& covariance, EyeSetup setup,
                      std::vector<std::string>& remarks) {
  constexpr double kWorse = 5;  // times the sigma of the next direction
  const auto eigen = symmetric_eigen(covariance.block(kMountColumn + 3, kMountColumn + 3, 3, 3));
  if (!eigen || !(eigen->values(2) > kWorse * kWorse * std::max(eigen->values(1), 0.0))) return;
  const Eigen::Vector3d along = eigen->vectors.col(2);
  remarks.push_back(fmt::format(
      "Along {:.2f} {:.2f} {:.2f} of the {} the place of the camera is known to {} mm only, as "
      "the hand was turned about nearly one axis: take some more pictures with it turned about "
      "another.",
      along[0], along[1], along[2], setup == EyeSetup::kInHand ? "hand" : "base",
      two_digits(std::sqrt(eigen->values(2)) / kMillimetre)));
}

void remark_noise(const HandEyeFit& fit, const HandEyeTask& task,
                  std::vector<std::string>& remarks) {
  constexpr double kFar = 2;  // times what was given
  if ((task.turn_sigma && fit.found.turn > kFar * *task.turn_sigma) ||
      (task.place_sigma && fit.found.place > kFar * *task.place_sigma)) {
    remarks.push_back(fmt::format(
        "The robot's poses are worse than was given: {} degrees and {} mm per axis go with "
        "the pictures. The sigmas are by what was given.",
        two_digits(fit.found.turn * 180 / std::numbers::pi),
        two_digits(fit.found.place / kMillimetre)));
  }
}

void remark_rejected(const std::vector<LoopError>& loops, std::vector<std::string>& remarks) {
  const auto rejected = std::ranges::count(loops, false, &LoopError::used);
  if (rejected == 0) return;
  remarks.push_back(
      fmt::format("{} of {} views contradict the others and were left out: their "
                  "pictures may have been taken while the robot moved.",
                  rejected, loops.size()));
}

}  // namespace

std::vector<LoopError> loop_errors(const std::vector<LoopView>& loops, const HandEyeFit& fit,
                                   EyeSetup setup, const std::vector<SE3>& camera_from_board) {
  std::vector<LoopError> errors;
  for (std::size_t v = 0; v < loops.size(); ++v) {
    const Vector6d error =
        hand_error(expected_hand(fit.places, setup, camera_from_board[v]), loops[v].base_from_hand);
    errors.push_back({loops[v].seen.front().view->of.view,
                      fit.used[v],
                      {error[0], error[1], error[2]},
                      {error[3], error[4], error[5]}});
  }
  return errors;
}

void set_found(const HandEyeFit& fit, const std::vector<LoopError>& loops, double weight_sigma,
               HandEye& to) {
  to.mount_from_camera = to_pose(fit.places.mount_from_camera);
  to.carrier_from_board = to_pose(fit.places.carrier_from_board);
  constexpr int k = 6;
  const Eigen::MatrixXd covariance = fit.covariance_of_places();
  to.mount_covariance = row_major(covariance.block(kMountColumn, kMountColumn, k, k));
  to.carrier_covariance = row_major(covariance.block(kCarrierColumn, kCarrierColumn, k, k));
  to.rms = fit.rms.all;
  to.corner_factor = fit.corner / weight_sigma;
  to.robot_turn_sigma = fit.noise.turn;
  to.robot_place_sigma = fit.noise.place;
  set_loop_rms(loops, to);
}

void add_hand_eye_remarks(const HandEyeFit& fit, const std::vector<LoopError>& loops,
                          const Board& board, const HandEyeTask& task, HandEye& to) {
  remark_scale(to, board, task.free_scale, to.remarks);
  remark_direction(fit.covariance_of_places(), task.setup, to.remarks);
  remark_noise(fit, task, to.remarks);
  remark_rejected(loops, to.remarks);
}

std::optional<LengthRatio> scale_of(const HandEyeFit& fit) {
  constexpr double kMostSigma = 0.5;  // beyond it is no measurement
  const double variance = fit.covariance_of_places()(kScaleColumn, kScaleColumn);
  if (!(variance < kMostSigma * kMostSigma)) return std::nullopt;
  return LengthRatio{fit.places.scale, std::sqrt(variance)};
}

}  // namespace calvin::rig
