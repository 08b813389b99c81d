// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Estimates the noise of corners and robot with the other unknowns: each variance is the sum of its
// squared residuals over their redundancy, again until nothing changes (W. Foerstner 1979; the
// fixed point is that of restricted maximum likelihood).

#include "calvin/rig/hand_eye/fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/geometry/median.hpp"
#include "calvin/rig/hand_eye/problem.hpp"
#include "calvin/rig/hand_eye/start.hpp"
#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/solve/linear/lm.hpp"

namespace calvin::rig {

namespace {

constexpr RobotNoise kLeastNoise = {1e-7, 1e-7};  // below what a double of a pose file resolves

// What is free of the cameras and the board.
ParameterTable free_table(const std::vector<Camera>& cameras, const HandEyeTask& task) {
  BoardUnknowns board;
  board.has_aspect = task.free_aspect;
  ParameterTable table = table_of(cameras, board);
  return task.free_cameras ? table : with_held_intrinsics(table, values_of_cameras(table, cameras));
}

class HandEyeSolver {
 public:
  HandEyeSolver(const std::vector<LoopView>& loops, const HandEyePlaces& start,
                const RobotNoise& noise, const MountedCameras& mounted, const HandEyeTask& task,
                const std::stop_token& stop)
      : loops_(loops),
        task_(task),
        stop_(stop),
        noise_{task.turn_sigma.value_or(std::max(noise.turn, kLeastNoise.turn)),
               task.place_sigma.value_or(std::max(noise.place, kLeastNoise.place))},
        mounted_(mounted),
        table_(free_table(mounted.cameras, task)),
        corners_(loops, task.free_aspect),
        used_(loops.size(), true) {
    point_.places = start;
    for (const LoopView& loop : loops) point_.camera_from_board.push_back(loop.camera_from_board);
    point_.shared = values_of_cameras(table_, mounted.cameras);
    point_.camera_from_first = mounted.camera_from_first;
    const LoopCorners::Kept kept = corners_.leave_out_by_views(mounted.cameras);
    if (kept.sigma > 0) corner_ = kept.sigma;
  }

  [[nodiscard]] Status run() {
    const int rounds = task_.free_cameras ? 6 : 3;
    for (int round = 0; round < rounds; ++round) {
      if (!estimate()) return undetermined(task_);
      const bool other_views = leave_out_views();
      const bool other_corners = task_.free_cameras && leave_out_corners();
      if (!other_views && !other_corners) break;
    }
    if (stop_.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
    return {};
  }

  [[nodiscard]] HandEyeFit result() const {
    HandEyeFit fit;
    fit.places = point_.places;
    fit.mounted = mounted_;
    fit.aspect = aspect();
    fit.camera_from_board = point_.camera_from_board;
    fit.table = table_;
    fit.noise = noise_;
    fit.found = found_;
    fit.corner = corner_;
    fit.used = used_;
    fit.rms = corners_.rms(geometry(), used_);
    return fit;
  }

  [[nodiscard]] std::optional<Eigen::MatrixXd> covariance(
      const std::vector<RigCameraViews>& calibrations) {
    HandEyeProblem problem = make_problem();
    if (!problem.valid()) return std::nullopt;
    if (task_.free_cameras) {
      const auto shared = problem.covariance();
      if (!shared) return std::nullopt;
      return corner_ * corner_ * *shared;
    }
    const auto information = problem.information();
    if (!information) return std::nullopt;
    const ParameterRange free = {problem.first_place(), problem.free_places()};
    const auto places =
        covariance_of_places(*information, free, corner_ * corner_,
                             covariance_of_intrinsics(problem.table(), calibrations));
    if (!places) return std::nullopt;
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(information->rows(), information->rows());
    all.block(free.first, free.first, free.count, free.count) = places->of_places;
    return all;
  }

  [[nodiscard]] static tl::unexpected<Error> undetermined(const HandEyeTask& task) {
    if (task.free_cameras) {
      return make_error(ErrorCode::kDegenerate,
                        "The poses of the robot and the pictures do not determine the cameras, "
                        "where they are and the board together: take more poses, the board tilted "
                        "to all sides and all over the pictures, the hand moved as well as turned "
                        "about two axes or more; or hold what is known of the board.");
    }
    return make_error(ErrorCode::kDegenerate,
                      "The poses of the robot and the pictures do not determine where the camera "
                      "is: take more poses, the hand turned about two axes or more.");
  }

 private:
  // How much farther apart the rows of the board are than its columns.
  [[nodiscard]] double aspect() const {
    const ParameterRange range = table_.aspect(0);
    return range.empty() ? 1 : 1 + point_.shared[static_cast<std::size_t>(range.first)];
  }
  [[nodiscard]] LoopGeometry geometry() const {
    return {mounted_, point_.camera_from_board, aspect()};
  }

  // By cameras that are other ones than those by which corners were left out before. Whether the
  // next estimate has others.
  [[nodiscard]] bool leave_out_corners() {
    const LoopCorners::Kept kept = corners_.leave_out(geometry());
    if (kept.changed) corner_ = kept.sigma;
    return kept.changed;
  }

  [[nodiscard]] HandEyeProblem make_problem() {
    std::vector<HandEyeBlock> blocks;
    HandEyePoint start = point_;
    start.camera_from_board.clear();
    for (std::size_t v = 0; v < loops_.size(); ++v) {
      if (!used_[v]) continue;
      blocks.push_back({corners_.seen(v), loops_[v].base_from_hand});
      start.camera_from_board.push_back(point_.camera_from_board[v]);
    }
    return HandEyeProblem(table_, std::move(blocks), task_.setup,
                          {corner_ / noise_.turn, corner_ / noise_.place}, task_.free_scale,
                          std::move(start));
  }

  // Takes what was found. False where it is no camera.
  [[nodiscard]] bool take(const HandEyePoint& found) {
    std::size_t block = 0;
    for (std::size_t v = 0; v < loops_.size(); ++v) {
      if (used_[v]) point_.camera_from_board[v] = found.camera_from_board[block++];
    }
    point_.places = found.places;
    point_.shared = found.shared;
    point_.camera_from_first = mounted_.camera_from_first = found.camera_from_first;
    if (!task_.free_cameras) return true;
    for (std::size_t c = 0; c < mounted_.cameras.size(); ++c) {
      Camera& camera = mounted_.cameras[c];
      const auto values = values_of(point_.shared, table_.intrinsics(c));
      auto made = Camera::make(camera.model(), camera.image_size(), {values.begin(), values.end()},
                               camera.skew());
      if (!made) return false;
      camera = *std::move(made);
    }
    return true;
  }

  // All unknowns and the noise together.
  [[nodiscard]] bool estimate() {
    constexpr int kMost = 60;
    constexpr double kSmall = 1e-3;  // of a sigma: far below how well any is known
    for (int step = 0; step < kMost && !stop_.stop_requested(); ++step) {
      HandEyeProblem problem = make_problem();
      if (!problem.valid()) return false;
      (void)minimise(problem, LmOptions{}, stop_);
      if (!take(problem.point())) return false;
      if (!problem.linearise_current()) return false;
      const auto redundancy = problem.redundancy();
      if (!redundancy) return false;
      keep_squares(problem.squares());
      if (!set_noise(problem, *redundancy, kSmall)) return true;
    }
    return true;
  }

  void keep_squares(const std::vector<LoopSums>& squares) {
    squares_.assign(loops_.size(), 0);
    std::size_t block = 0;
    for (std::size_t v = 0; v < loops_.size(); ++v) {
      if (!used_[v]) continue;
      squares_[v] = squares[block].turn + squares[block].place;
      ++block;
    }
  }

  // The next noise, whether it has changed by more than `small` of it.
  bool set_noise(const HandEyeProblem& problem, const LoopSums& redundancy, double small) {
    LoopSums sum;
    for (const LoopSums& one : problem.squares()) {
      sum.turn += one.turn;
      sum.place += one.place;
    }
    double corners = 0;
    for (std::size_t v = 0; v < loops_.size(); ++v) {
      if (used_[v]) corners += static_cast<double>(corners_.count(v));
    }
    const double free = 2 * corners - problem.free_unknowns() - redundancy.turn - redundancy.place;
    const double of_corners = std::max(problem.cost() - sum.turn - sum.place, 0.0);
    // Of a sigma that is 0 the ratios mean nothing: they are bounded.
    const auto ratio = [](double square, double degrees) {
      return std::clamp(std::sqrt(square / std::max(degrees, 1e-9)), 0.1, 10.0);
    };
    const double by_turn = ratio(sum.turn / corner_ / corner_, redundancy.turn);
    const double by_place = ratio(sum.place / corner_ / corner_, redundancy.place);
    const double by_corner = ratio(of_corners / corner_ / corner_, free);
    found_ = {noise_.turn * by_turn, noise_.place * by_place};
    const RobotNoise before = noise_;
    const double corner = corner_;
    if (!task_.turn_sigma) noise_.turn = std::max(found_.turn, kLeastNoise.turn);
    if (!task_.place_sigma) noise_.place = std::max(found_.place, kLeastNoise.place);
    corner_ = std::max(corner_ * by_corner, 1e-9);
    const auto differs = [small](double a, double b) { return std::abs(a - b) > small * b; };
    return differs(noise_.turn, before.turn) || differs(noise_.place, before.place) ||
           differs(corner_, corner);
  }

  // Views whose loops are far worse than those of most. Whether any was left out that was not
  // before.
  [[nodiscard]] bool leave_out_views() {
    constexpr double kMedian = 5.348;   // of chi^2 with the 6 degrees of a loop
    constexpr double kFar = 50;         // of that chi^2: 5e-9 of all loops are beyond by chance
    constexpr std::size_t kFewest = 8;  // loops of which a median says something
    std::vector<double> sums;
    for (std::size_t v = 0; v < loops_.size(); ++v) {
      if (used_[v]) sums.push_back(squares_[v]);
    }
    if (sums.size() < kFewest) return false;
    const double limit = kFar / kMedian * median_of(sums);
    bool changed = false;
    for (std::size_t v = 0; v < loops_.size(); ++v) {
      if (!used_[v] || !(squares_[v] > limit)) continue;
      used_[v] = false;
      changed = true;
    }
    return changed;
  }

  const std::vector<LoopView>& loops_;
  const HandEyeTask& task_;
  const std::stop_token& stop_;
  RobotNoise noise_;
  RobotNoise found_;
  double corner_ = 1;  // px, of a corner with the weight 1
  MountedCameras mounted_;
  ParameterTable table_;
  LoopCorners corners_;
  HandEyePoint point_;  // with the poses of all loops
  std::vector<bool> used_;
  std::vector<double> squares_;  // px^2, of each loop
};

}  // namespace

Result<HandEyeFit> fit_hand_eye(const std::vector<LoopView>& loops, const HandEyePlaces& start,
                                const RobotNoise& noise, const MountedCameras& mounted,
                                const std::vector<RigCameraViews>& calibrations,
                                const HandEyeTask& task, const std::stop_token& stop) {
  HandEyeSolver solver(loops, start, noise, mounted, task, stop);
  if (const Status solved = solver.run(); !solved) return tl::unexpected<Error>(solved.error());
  HandEyeFit fit = solver.result();
  auto covariance = solver.covariance(calibrations);
  if (!covariance) return HandEyeSolver::undetermined(task);
  fit.covariance = *std::move(covariance);
  return fit;
}

}  // namespace calvin::rig
