// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The steps of a hand-eye calibration: views, start, checks, least squares, and what is said of the
// result.

#include "calvin/rig/hand_eye.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/core/text.hpp"
#include "calvin/geometry/symmetric.hpp"
#include "calvin/rig/board_views.hpp"
#include "calvin/rig/hand_eye/check.hpp"
#include "calvin/rig/hand_eye/fit.hpp"

namespace calvin {

namespace {

using rig::BoardView;
using rig::LoopView;

constexpr std::size_t kFewest = 3;      // poses
constexpr double kMillimetre = 1e-3;    // m
constexpr double kMedianNorm = 1.5382;  // of three normal coordinates, in their sigma

Status check_poses(const RigCameraViews& seen, const std::vector<Pose>& base_from_hand) {
  if (seen.views.size() != base_from_hand.size()) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("There are {} views and {} poses of the robot: give a pose for "
                                  "each.",
                                  seen.views.size(), base_from_hand.size()));
  }
  const auto is_far = [](double x) { return !(std::abs(x) <= 1e6); };
  for (std::size_t i = 0; i < base_from_hand.size(); ++i) {
    if (std::ranges::any_of(base_from_hand[i].rotation, is_far) ||
        std::ranges::any_of(base_from_hand[i].translation, is_far)) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("Pose {} of the robot is not finite, or out of range (1e6 m, "
                                    "1e6 rad).",
                                    i + 1));
    }
  }
  return {};
}

Status check_options(const HandEyeOptions& options) {
  const auto is_wrong = [](const std::optional<double>& sigma) {
    return sigma && !(*sigma > 0 && *sigma < 1e3);
  };
  if (!is_wrong(options.turn_sigma) && !is_wrong(options.place_sigma)) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    "The noise of a robot is more than 0 and less than 1000 (rad, m).");
}

Status check_views(const std::vector<BoardView>& views) {
  if (std::ranges::any_of(views, [&](const BoardView& v) { return v.board != views[0].board; })) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The views show several boards: give those of one.");
  }
  if (views.size() >= kFewest) return {};
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("{} views show the board with a pose of the robot, and {} are the "
                                "least: take ten or more, the hand turned about several axes.",
                                views.size(), kFewest));
}

tl::unexpected<Error> undecided() {
  return make_error(ErrorCode::kDegenerate,
                    "The poses of the robot and the pictures leave open where the camera is: the "
                    "board looks the same when it is turned, or it is seen from far away and flat. "
                    "Take more poses, with the board larger and tilted, or a board that names its "
                    "corners, as puzzle:14x9:20mm.");
}

std::vector<double> row_major(const Eigen::MatrixXd& matrix) {
  std::vector<double> all;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) all.push_back(matrix(r, c));
  }
  return all;
}

// By the corners of each view alone, in the tilt and with the labels that the others agree with.
std::vector<LoopError> loops_of(const std::vector<LoopView>& views, const rig::HandEyeFit& fit,
                                EyeSetup setup) {
  std::vector<LoopError> loops;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const rig::Vector6d error =
        rig::hand_error(rig::expected_hand(fit.places, setup, views[v].pose.camera_from_board),
                        views[v].base_from_hand);
    loops.push_back({views[v].view->of.view,
                     fit.used[v],
                     {error[0], error[1], error[2]},
                     {error[3], error[4], error[5]}});
  }
  return loops;
}

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

// ---- Remarks ------------------------------------------------------------------------------------

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
  const auto eigen =
      symmetric_eigen(covariance.block(rig::kMountColumn + 3, rig::kMountColumn + 3, 3, 3));
  if (!eigen || !(eigen->values(2) > kWorse * kWorse * std::max(eigen->values(1), 0.0))) return;
  const Eigen::Vector3d along = eigen->vectors.col(2);
  remarks.push_back(fmt::format(
      "Along {:.2f} {:.2f} {:.2f} of the {} the place of the camera is known to {} mm only, as "
      "the hand was turned about nearly one axis: take some more pictures with it turned about "
      "another.",
      along[0], along[1], along[2], setup == EyeSetup::kInHand ? "hand" : "base",
      two_digits(std::sqrt(eigen->values(2)) / kMillimetre)));
}

void remark_noise(const rig::HandEyeFit& fit, const HandEyeOptions& options,
                  std::vector<std::string>& remarks) {
  constexpr double kFar = 2;  // times what was given
  if ((options.turn_sigma && fit.found.turn > kFar * *options.turn_sigma) ||
      (options.place_sigma && fit.found.place > kFar * *options.place_sigma)) {
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

// ---- The steps ----------------------------------------------------------------------------------

class Solver {
 public:
  Solver(const RigCameraViews& seen, const Camera& camera, const HandEyeOptions& options,
         const std::stop_token& stop)
      : seen_(seen), camera_(camera), options_(options), stop_(stop) {}

  [[nodiscard]] Result<HandEyeSolution> run(const std::vector<BoardView>& views,
                                            const std::vector<Pose>& base_from_hand) {
    const Status started = start(views, base_from_hand);
    if (!started) return tl::unexpected<Error>(started.error());
    const auto fit = fit_with(options_.free_scale, start_, noise_);
    if (!fit) return tl::unexpected<Error>(fit.error());
    // Turns about one axis seem to be about several by their noise alone.
    const Status turned = rig::check_turns(sightings_, options_.setup, fit->noise.turn);
    if (!turned) return tl::unexpected<Error>(turned.error());
    HandEyeSolution solution;
    solution.loops = loops_of(loops_, *fit, options_.setup);
    HandEye& result = solution.result;
    result.setup = options_.setup;
    result.calibration = seen_.calibration;
    result.mount_from_camera = to_pose(fit->places.mount_from_camera);
    result.carrier_from_board = to_pose(fit->places.carrier_from_board);
    constexpr int k = 6;
    result.mount_covariance =
        row_major(fit->covariance.block(rig::kMountColumn, rig::kMountColumn, k, k));
    result.carrier_covariance =
        row_major(fit->covariance.block(rig::kCarrierColumn, rig::kCarrierColumn, k, k));
    result.rms = fit->rms;
    result.corner_factor = fit->corner / views.front().sigma;
    result.robot_turn_sigma = fit->noise.turn;
    result.robot_place_sigma = fit->noise.place;
    result.scale = scale_by(*fit);
    set_loop_rms(solution.loops, result);
    const Board& board = seen_.views[views.front().of.view].board;
    remark_scale(result, board, options_.free_scale, result.remarks);
    remark_direction(fit->covariance, options_.setup, result.remarks);
    remark_noise(*fit, options_, result.remarks);
    remark_rejected(solution.loops, result.remarks);
    return solution;
  }

 private:
  // Where everything is, about, and which pose and labels of each view go with it.
  [[nodiscard]] Status start(const std::vector<BoardView>& views,
                             const std::vector<Pose>& base_from_hand) {
    std::vector<rig::Sighting>& sightings = sightings_;
    for (const BoardView& view : views) {
      sightings.push_back(rig::sighting_of(view, to_se3(base_from_hand[view.of.view])));
    }
    if (const Status turned = rig::check_turns(sightings, options_.setup, 0); !turned) {
      return turned;
    }
    const auto found = rig::find_start(sightings, options_.setup, options_.free_scale);
    if (const Status closed = rig::check_loops(found, sightings, options_.setup); !closed) {
      return closed;
    }
    noise_ = {found->turn / kMedianNorm, found->place / kMedianNorm};
    if (!found->is_decided) return undecided();
    start_ = found->places;
    for (std::size_t v = 0; v < views.size(); ++v) {
      loops_.push_back(
          {&views[v], sightings[v].poses[found->poses[v]], sightings[v].base_from_hand});
    }
    return {};
  }

  [[nodiscard]] Result<rig::HandEyeFit> fit_with(bool free_scale, const rig::HandEyePlaces& from,
                                                 const rig::RobotNoise& noise) const {
    const rig::HandEyeTask task = {options_.setup, free_scale, options_.turn_sigma,
                                   options_.place_sigma};
    return rig::fit_hand_eye(loops_, from, noise, seen_, camera_, task, stop_);
  }

  // The ratio of lengths by a fit of its own, unless it was free anyway. A hand that stayed in its
  // place says nothing of it.
  [[nodiscard]] std::optional<LengthRatio> scale_by(const rig::HandEyeFit& fit) const {
    constexpr double kMostSigma = 0.5;  // beyond it is no measurement
    const auto ratio = [](const rig::HandEyeFit& by) -> std::optional<LengthRatio> {
      const double variance = by.covariance(rig::kScaleColumn, rig::kScaleColumn);
      if (!(variance < kMostSigma * kMostSigma)) return std::nullopt;
      return LengthRatio{by.places.scale, std::sqrt(variance)};
    };
    if (options_.free_scale) return ratio(fit);
    const auto free = fit_with(true, fit.places, fit.noise);
    return free ? ratio(*free) : std::nullopt;
  }

  const RigCameraViews& seen_;
  const Camera& camera_;
  const HandEyeOptions& options_;
  const std::stop_token& stop_;
  rig::HandEyePlaces start_;
  rig::RobotNoise noise_;
  std::vector<rig::Sighting> sightings_;
  std::vector<LoopView> loops_;
};

}  // namespace

Result<HandEyeSolution> solve_hand_eye(const RigCameraViews& camera,
                                       const std::vector<Pose>& base_from_hand,
                                       const HandEyeOptions& options, std::stop_token stop) {
  try {
    for (const Status& checked : {check_poses(camera, base_from_hand), check_options(options)}) {
      if (!checked) return tl::unexpected<Error>(checked.error());
    }
    const auto lens = Camera::make(camera.calibration);
    if (!lens) return tl::unexpected<Error>(lens.error());
    const auto views = rig::board_views({camera}, {*lens});
    if (!views) return tl::unexpected<Error>(views.error());
    if (const Status enough = check_views(*views); !enough) {
      return tl::unexpected<Error>(enough.error());
    }
    return Solver(camera, *lens, options, stop).run(*views, base_from_hand);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kDegenerate, "There is no memory for so many views: take fewer.");
  }
}

}  // namespace calvin
