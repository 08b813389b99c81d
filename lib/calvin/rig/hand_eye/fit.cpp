// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Estimates the noise of corners and robot with the places: each variance is the sum of its squared
// residuals over their redundancy, again until nothing changes (W. Foerstner 1979; the fixed point
// is that of restricted maximum likelihood).

#include "calvin/rig/hand_eye/fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/rig/hand_eye/problem.hpp"
#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/solve/linear/lm.hpp"

namespace calvin::rig {

namespace {

constexpr RobotNoise kLeastNoise = {1e-7, 1e-7};  // below what a double of a pose file resolves
constexpr double kMedianDistance = 1.17741;       // of two normal coordinates, in their sigma

// Of the corners in use, weighted, px; 0 for the others.
std::vector<double> distances(const PointSet& seen, const Camera& camera, const SE3& pose) {
  std::vector<double> all;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto at = camera.project(pose * seen.points[i]);
    const bool counts = at && seen.weight[i] > 0;
    all.push_back(counts ? seen.weight[i] * std::hypot(at->u - seen.uv[i].u, at->v - seen.uv[i].v)
                         : 0);
  }
  return all;
}

class HandEyeSolver {
 public:
  HandEyeSolver(const std::vector<LoopView>& views, const HandEyePlaces& start,
                const RobotNoise& noise, const Camera& camera, const HandEyeTask& task,
                const std::stop_token& stop)
      : views_(views), camera_(camera), task_(task), stop_(stop), noise_(noise), places_(start) {
    noise_ = {task.turn_sigma.value_or(std::max(noise.turn, kLeastNoise.turn)),
              task.place_sigma.value_or(std::max(noise.place, kLeastNoise.place))};
    for (const LoopView& view : views) {
      PointSet seen = view.view->seen;
      for (Eigen::Vector3d& point : seen.points) point = view.pose.board_from_own * point;
      seen.motion.clear();
      sets_.push_back(std::move(seen));
      poses_.push_back(view.pose.camera_from_board);
    }
    used_.assign(views.size(), true);
    leave_out_corners();
    for (const PointSet& set : sets_) points_.emplace_back(set, BoardShape());
  }

  [[nodiscard]] Status run() {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      if (!estimate()) return undetermined();
      if (!leave_out_views()) break;
    }
    if (stop_.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
    return {};
  }

  [[nodiscard]] HandEyeFit result() const {
    HandEyeFit fit;
    fit.places = places_;
    fit.noise = noise_;
    fit.found = found_;
    fit.corner = corner_;
    fit.used = used_;
    fit.rms = rms();
    return fit;
  }

  [[nodiscard]] std::optional<Eigen::MatrixXd> covariance(const RigCameraViews& calibration) {
    HandEyeProblem problem = make_problem();
    const auto information = problem.valid() ? problem.information() : std::nullopt;
    if (!information) return std::nullopt;
    return covariance_of_places(*information, {problem.first_place(), problem.free_places()},
                                corner_ * corner_,
                                covariance_of_intrinsics(problem.table(), {calibration}));
  }

  [[nodiscard]] static tl::unexpected<Error> undetermined() {
    return make_error(ErrorCode::kDegenerate,
                      "The poses of the robot and the pictures do not determine where the camera "
                      "is: take more poses, the hand turned about two axes or more.");
  }

 private:
  // Corners that are far off what the other ones of their view say.
  void leave_out_corners() {
    constexpr double kFar = 6;  // sigmas
    std::vector<double> all;
    for (std::size_t v = 0; v < sets_.size(); ++v) {
      for (const double d : distances(sets_[v], camera_, poses_[v])) {
        if (d > 0) all.push_back(d);
      }
    }
    if (all.empty()) return;
    corner_ = std::max(median(std::move(all)) / kMedianDistance, 1e-9);
    for (std::size_t v = 0; v < sets_.size(); ++v) {
      constexpr std::size_t kFewest = 4;
      const auto far = distances(sets_[v], camera_, poses_[v]);
      PointSet cleaned = sets_[v];
      for (std::size_t i = 0; i < far.size(); ++i) {
        if (far[i] > kFar * corner_) cleaned.weight[i] = 0;
      }
      if (cleaned.used() >= kFewest) sets_[v] = std::move(cleaned);
    }
  }

  [[nodiscard]] HandEyeProblem make_problem() {
    std::vector<HandEyeBlock> blocks;
    HandEyePoint start{places_, {}};
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (!used_[v]) continue;
      blocks.push_back({&points_[v], views_[v].base_from_hand});
      start.camera_from_board.push_back(poses_[v]);
    }
    return HandEyeProblem(camera_, std::move(blocks), task_.setup,
                          {corner_ / noise_.turn, corner_ / noise_.place}, task_.free_scale,
                          std::move(start));
  }

  // Places and noise together.
  [[nodiscard]] bool estimate() {
    constexpr int kMost = 60;
    constexpr double kSmall = 1e-3;  // of a sigma: far below how well any is known
    for (int step = 0; step < kMost && !stop_.stop_requested(); ++step) {
      HandEyeProblem problem = make_problem();
      if (!problem.valid()) return false;
      (void)minimise(problem, LmOptions{}, stop_);
      places_ = problem.point().places;
      std::size_t block = 0;
      for (std::size_t v = 0; v < views_.size(); ++v) {
        if (used_[v]) poses_[v] = problem.point().camera_from_board[block++];
      }
      if (!problem.linearise_current()) return false;
      const auto redundancy = problem.redundancy();
      if (!redundancy) return false;
      keep_squares(problem.squares());
      if (!set_noise(problem, *redundancy, kSmall)) return true;
    }
    return true;
  }

  void keep_squares(const std::vector<LoopSums>& squares) {
    squares_.assign(views_.size(), 0);
    std::size_t block = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
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
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (used_[v]) corners += static_cast<double>(sets_[v].used());
    }
    const double free = 2 * corners - problem.free_places() - redundancy.turn - redundancy.place;
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
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (used_[v]) sums.push_back(squares_[v]);
    }
    if (sums.size() < kFewest) return false;
    const double limit = kFar / kMedian * median(sums);
    bool changed = false;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (!used_[v] || !(squares_[v] > limit)) continue;
      used_[v] = false;
      changed = true;
    }
    return changed;
  }

  [[nodiscard]] double rms() const {
    double squares = 0;
    double corners = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (!used_[v]) continue;
      const auto far = distances(sets_[v], camera_, poses_[v]);
      for (std::size_t i = 0; i < far.size(); ++i) {
        if (!(sets_[v].weight[i] > 0)) continue;
        squares += std::pow(far[i] / sets_[v].weight[i], 2);
        corners += 1;
      }
    }
    return corners > 0 ? std::sqrt(squares / corners) : 0;
  }

  const std::vector<LoopView>& views_;
  const Camera& camera_;
  const HandEyeTask& task_;
  const std::stop_token& stop_;
  RobotNoise noise_;
  RobotNoise found_;
  double corner_ = 1;  // px, of a corner with the weight 1
  HandEyePlaces places_;
  std::vector<SE3> poses_;  // camera_from_board of all views
  std::vector<bool> used_;
  std::vector<double> squares_;  // px^2, of the loop of each view
  std::vector<PointSet> sets_;   // with the labels of the board
  std::vector<ViewPoints> points_;
};

}  // namespace

Result<HandEyeFit> fit_hand_eye(const std::vector<LoopView>& views, const HandEyePlaces& start,
                                const RobotNoise& noise, const RigCameraViews& calibration,
                                const Camera& camera, const HandEyeTask& task,
                                const std::stop_token& stop) {
  HandEyeSolver solver(views, start, noise, camera, task, stop);
  if (const Status solved = solver.run(); !solved) return tl::unexpected<Error>(solved.error());
  HandEyeFit fit = solver.result();
  const auto covariance = solver.covariance(calibration);
  if (!covariance) return HandEyeSolver::undetermined();
  fit.covariance = *covariance;
  return fit;
}

}  // namespace calvin::rig
