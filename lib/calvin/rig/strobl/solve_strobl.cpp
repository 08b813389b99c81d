// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The steps of a joint solve: views, first loops, one least squares, and what of it is determined.

#include "calvin/rig/strobl/solve_strobl.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/rig/board_views.hpp"
#include "calvin/rig/hand_eye/check.hpp"
#include "calvin/rig/strobl/joint_estimates.hpp"
#include "calvin/rig/strobl/joint_loops.hpp"
#include "calvin/solve/start/pose_fit.hpp"

namespace calvin {

namespace {

using rig::BoardView;

// What all cameras have seen, checked.
struct Seen {
  std::vector<RigCameraViews> views;
  std::vector<Camera> cameras;
  std::vector<std::string> names;
};

Result<Seen> seen_by(const std::vector<RobotCamera>& cameras, std::size_t poses) {
  if (cameras.empty()) {
    return make_error(ErrorCode::kInvalidArgument, "There is no camera: give one or more.");
  }
  Seen all;
  std::set<std::string> names;
  for (const RobotCamera& one : cameras) {
    const std::string& name = one.seen.calibration.camera;
    if (!names.insert(name).second) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("Two cameras are called '{}': give each its own name, by which "
                                    "it is told from the others.",
                                    name));
    }
    if (one.pose_of_view.size() != one.seen.views.size() ||
        std::ranges::any_of(one.pose_of_view, [&](std::size_t pose) { return pose >= poses; })) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("Of '{}' there are {} views and {} poses of the robot for "
                                    "them, of {}: give a pose for each view.",
                                    name, one.seen.views.size(), one.pose_of_view.size(), poses));
    }
    auto camera = Camera::make(one.seen.calibration);
    if (!camera) {
      return make_error(camera.error().code,
                        fmt::format("The calibration of '{}': {}", name, camera.error().message));
    }
    all.cameras.push_back(*std::move(camera));
    all.views.push_back(one.seen);
    all.names.push_back(name);
  }
  return all;
}

rig::HandEyeTask task_of(const StroblOptions& options) {
  rig::HandEyeTask task;
  task.setup = options.setup;
  task.turn_sigma = options.turn_sigma;
  task.place_sigma = options.place_sigma;
  task.free_scale = !options.pitch_known;
  task.free_cameras = true;
  task.free_aspect = !options.aspect_known;
  return task;
}

// The pose of the board by the corners of the first view alone, in the tilt that the others agree
// with; the pose of the fit where they give none.
SE3 pose_by_corners(const rig::LoopView& loop, const rig::HandEyeFit& fit, std::size_t number) {
  const rig::SeenBoard& seen = loop.seen.front();
  const SE3& pose = fit.camera_from_board[number];
  const std::size_t camera = seen.view->of.camera;
  const SE3& from_first = fit.mounted.camera_from_first[camera];
  const auto own =
      fit_pose(rig::with_labels(seen, fit.aspect), fit.mounted.cameras[camera], Loss{});
  if (!own) return pose;
  const Eigen::Matrix3d turned = from_first.rotation * pose.rotation;
  const bool is_other =
      (own->other.rotation - turned).norm() < (own->camera_from_board.rotation - turned).norm();
  return from_first.inverse() * (is_other ? own->other : own->camera_from_board);
}

void remark_aspect(const HandEye& found, const Board& board, std::vector<std::string>& remarks) {
  constexpr double kSignificant = 3;  // sigmas
  if (!found.aspect || !(std::abs(found.aspect->value - 1) > kSignificant * found.aspect->sigma)) {
    return;
  }
  const auto grid = board.grid();
  std::string text = fmt::format(
      "Rows of the board are {:.3f} % {} apart than its columns (+-{} %)",
      100 * std::abs(found.aspect->value - 1), found.aspect->value > 1 ? "farther" : "less far",
      two_digits(100 * found.aspect->sigma));
  if (grid && found.scale) {
    constexpr double kMilli = 1e-3;  // m in a millimetre
    const double pitch = found.scale->value * grid->pitch / kMilli;
    text +=
        fmt::format(": {:.5g} mm down and {:.5g} mm across", pitch * found.aspect->value, pitch);
  }
  remarks.push_back(text + ".");
}

StroblSolution solution_of(const rig::HandEyeFit& fit, const rig::JointLoops& loops,
                           const rig::JointEstimates& estimates, const Seen& seen,
                           const rig::HandEyeTask& task) {
  StroblSolution solution;
  std::vector<SE3> by_corners;
  for (std::size_t v = 0; v < loops.loops.size(); ++v) {
    by_corners.push_back(pose_by_corners(loops.loops[v], fit, v));
  }
  solution.loops = rig::loop_errors(loops.loops, fit, task.setup, by_corners);
  const BoardView& view = *loops.loops.front().seen.front().view;
  HandEye& found = solution.hand_eye;
  found.setup = task.setup;
  rig::set_found(fit, solution.loops, view.sigma, found);
  for (std::size_t v = 0; v < loops.loops.size(); ++v) solution.loops[v].view = loops.poses[v];
  if (task.free_scale) found.scale = rig::scale_of(fit);
  if (task.free_aspect) {
    const int row = estimates.aspect.first;
    found.aspect = LengthRatio{fit.aspect, std::sqrt(estimates.covariance(row, row))};
  }
  const Board& board = seen.views[view.of.camera].views[view.of.view].board;
  std::vector<Calibration> known;
  for (const RigCameraViews& one : seen.views) known.push_back(one.calibration);
  solution.calibrations = rig::joint_calibrations(fit, estimates, loops.loops, known, board.text());
  found.calibration = solution.calibrations.front();
  if (known.size() > 1) solution.rig = rig::joint_rig(fit, estimates, solution.calibrations);
  rig::add_hand_eye_remarks(fit, solution.loops, board, task, found);
  remark_aspect(found, board, found.remarks);
  solution.names = estimates.names;
  solution.covariance = row_major(estimates.covariance);
  return solution;
}

Result<StroblSolution> solve_seen(const Seen& seen, const std::vector<BoardView>& views,
                                  const std::vector<std::size_t>& pose_of_view,
                                  const std::vector<SE3>& hands, const rig::HandEyeTask& task,
                                  const std::stop_token& stop) {
  const auto loops = rig::joint_loops(views, pose_of_view, hands, seen.cameras, seen.names,
                                      task.setup, task.free_scale);
  if (!loops) return tl::unexpected<Error>(loops.error());
  const std::vector<rig::Sighting>& sightings = loops->first.sightings;
  if (task.free_scale) {
    const Status sized = rig::check_lengths(sightings, task.setup);
    if (!sized) return tl::unexpected<Error>(sized.error());
  }
  const auto fit = rig::fit_hand_eye(loops->loops, loops->first.places, loops->first.noise,
                                     loops->mounted, seen.views, task, stop);
  // Turns about one axis seem to be about several by their noise alone.
  const double noise = fit ? fit->noise.turn : loops->first.noise.turn;
  const Status turned = rig::check_turns(sightings, task.setup, noise);
  const bool is_cancelled = !fit && fit.error().code == ErrorCode::kCancelled;
  if (!turned && !is_cancelled) return tl::unexpected<Error>(turned.error());
  if (!fit) return tl::unexpected<Error>(fit.error());
  const rig::JointEstimates estimates = rig::joint_estimates(*fit, task, seen.names);
  const Status determined = rig::check_determined(*fit, estimates, seen.names);
  if (!determined) return tl::unexpected<Error>(determined.error());
  return solution_of(*fit, *loops, estimates, seen, task);
}

}  // namespace

Result<StroblSolution> solve_strobl(const std::vector<RobotCamera>& cameras,
                                    const std::vector<Pose>& base_from_hand,
                                    const StroblOptions& options, std::stop_token stop) {
  try {
    const rig::HandEyeTask task = task_of(options);
    for (const Status& checked : {rig::check_poses(base_from_hand), rig::check_noise(task)}) {
      if (!checked) return tl::unexpected<Error>(checked.error());
    }
    const auto seen = seen_by(cameras, base_from_hand.size());
    if (!seen) return tl::unexpected<Error>(seen.error());
    const auto views = rig::board_views(seen->views, seen->cameras);
    if (!views) return tl::unexpected<Error>(views.error());
    std::vector<BoardView> of_first;
    std::vector<std::size_t> pose_of_view;
    for (const BoardView& view : *views) {
      if (view.of.camera == 0) of_first.push_back(view);
      pose_of_view.push_back(cameras[view.of.camera].pose_of_view[view.of.view]);
    }
    for (const Status& checked : {rig::check_one_board(*views), rig::check_enough(of_first)}) {
      if (!checked) return tl::unexpected<Error>(checked.error());
    }
    std::vector<SE3> hands;
    for (const Pose& pose : base_from_hand) hands.push_back(to_se3(pose));
    return solve_seen(*seen, *views, pose_of_view, hands, task, stop);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kDegenerate, "There is no memory for so many views: take fewer.");
  }
}

}  // namespace calvin
