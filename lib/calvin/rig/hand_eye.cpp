// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The steps of a hand-eye calibration: views, start, checks, least squares, and what is said of the
// result.

#include "calvin/rig/hand_eye.hpp"

#include <exception>
#include <utility>

#include <fmt/format.h>

#include "calvin/rig/board_views.hpp"
#include "calvin/rig/hand_eye/check.hpp"
#include "calvin/rig/hand_eye/first_loops.hpp"

namespace calvin {

namespace {

using rig::BoardView;

Status check_counts(std::size_t views, std::size_t poses) {
  if (views == poses) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("There are {} views and {} poses of the robot: give a pose for "
                                "each.",
                                views, poses));
}

rig::HandEyeTask task_of(const HandEyeOptions& options, bool free_scale) {
  rig::HandEyeTask task;
  task.setup = options.setup;
  task.free_scale = free_scale;
  task.turn_sigma = options.turn_sigma;
  task.place_sigma = options.place_sigma;
  return task;
}

class Solver {
 public:
  Solver(const RigCameraViews& seen, const Camera& camera, const HandEyeOptions& options,
         const std::stop_token& stop)
      : seen_(seen), camera_(camera), options_(options), stop_(stop) {}

  [[nodiscard]] Result<HandEyeSolution> run(const std::vector<BoardView>& views,
                                            const std::vector<Pose>& base_from_hand) {
    std::vector<const BoardView*> all;
    std::vector<SE3> hands;
    for (const BoardView& view : views) {
      all.push_back(&view);
      hands.push_back(to_se3(base_from_hand[view.of.view]));
    }
    auto first = rig::first_loops(all, hands, options_.setup, options_.free_scale);
    if (!first) return tl::unexpected<Error>(first.error());
    loops_ = std::move(first->loops);
    const auto fit = fit_with(options_.free_scale, first->places, first->noise);
    if (!fit) return tl::unexpected<Error>(fit.error());
    // Turns about one axis seem to be about several by their noise alone.
    const Status turned = rig::check_turns(first->sightings, options_.setup, fit->noise.turn);
    if (!turned) return tl::unexpected<Error>(turned.error());
    return solution_of(*fit, views.front());
  }

 private:
  [[nodiscard]] HandEyeSolution solution_of(const rig::HandEyeFit& fit,
                                            const BoardView& view) const {
    // In the tilt and with the labels that the others agree with.
    std::vector<SE3> by_corners;
    for (const rig::LoopView& loop : loops_) by_corners.push_back(loop.camera_from_board);
    HandEyeSolution solution;
    solution.loops = rig::loop_errors(loops_, fit, options_.setup, by_corners);
    HandEye& result = solution.result;
    result.setup = options_.setup;
    result.calibration = seen_.calibration;
    rig::set_found(fit, solution.loops, view.sigma, result);
    result.scale = scale_by(fit);
    rig::add_hand_eye_remarks(fit, solution.loops, seen_.views[view.of.view].board,
                              task_of(options_, options_.free_scale), result);
    return solution;
  }

  [[nodiscard]] Result<rig::HandEyeFit> fit_with(bool free_scale, const rig::HandEyePlaces& from,
                                                 const rig::RobotNoise& noise) const {
    return rig::fit_hand_eye(loops_, from, noise, {{camera_}, {SE3()}}, {seen_},
                             task_of(options_, free_scale), stop_);
  }

  // The ratio of lengths by a fit of its own, unless it was free anyway.
  [[nodiscard]] std::optional<LengthRatio> scale_by(const rig::HandEyeFit& fit) const {
    if (options_.free_scale) return rig::scale_of(fit);
    const auto free = fit_with(true, fit.places, fit.noise);
    return free ? rig::scale_of(*free) : std::nullopt;
  }

  const RigCameraViews& seen_;
  const Camera& camera_;
  const HandEyeOptions& options_;
  const std::stop_token& stop_;
  std::vector<rig::LoopView> loops_;
};

}  // namespace

Result<HandEyeSolution> solve_hand_eye(const RigCameraViews& camera,
                                       const std::vector<Pose>& base_from_hand,
                                       const HandEyeOptions& options, std::stop_token stop) {
  try {
    for (const Status& checked : {check_counts(camera.views.size(), base_from_hand.size()),
                                  rig::check_poses(base_from_hand),
                                  rig::check_noise(task_of(options, options.free_scale))}) {
      if (!checked) return tl::unexpected<Error>(checked.error());
    }
    const auto lens = Camera::make(camera.calibration);
    if (!lens) return tl::unexpected<Error>(lens.error());
    const auto views = rig::board_views({camera}, {*lens});
    if (!views) return tl::unexpected<Error>(views.error());
    for (const Status& checked : {rig::check_one_board(*views), rig::check_enough(*views)}) {
      if (!checked) return tl::unexpected<Error>(checked.error());
    }
    return Solver(camera, *lens, options, stop).run(*views, base_from_hand);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kDegenerate, "There is no memory for so many views: take fewer.");
  }
}

}  // namespace calvin
