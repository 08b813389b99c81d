// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Steps of Gauss-Newton over intrinsics, and what of them the views tell.

#include "calvin/rig/lenses/solve_with_lenses.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/solve/judge/projection_error.hpp"

namespace calvin::rig {

namespace {

// Where the intrinsics of each camera stand among those of all.
std::vector<ParameterRange> ranges_of(const std::vector<Camera>& cameras) {
  const ParameterTable table = table_of(cameras);
  std::vector<ParameterRange> ranges;
  for (std::size_t c = 0; c < cameras.size(); ++c) ranges.push_back(table.intrinsics(c));
  return ranges;
}

Result<std::vector<Camera>> cameras_at(const FreeIntrinsics& free,
                                       const std::vector<Camera>& before) {
  const Eigen::VectorXd values = free.known + free.directions * free.z;
  const std::vector<ParameterRange> ranges = ranges_of(before);
  std::vector<Camera> cameras;
  for (std::size_t c = 0; c < before.size(); ++c) {
    const double* own = values.data() + ranges[c].first;
    auto camera = Camera::make(std::string(before[c].model()), before[c].image_size(),
                               std::vector<double>(own, own + ranges[c].count), before[c].skew());
    if (!camera) return tl::unexpected<Error>(camera.error());
    cameras.push_back(*std::move(camera));
  }
  return cameras;
}

Eigen::MatrixXd covariance_of(const FreeIntrinsics& free, const IntrinsicsStep& step,
                              ParameterRange range) {
  const Eigen::MatrixXd own = free.directions.middleRows(range.first, range.count);
  return congruent(step.of_z, own.transpose());
}

// Why the views do not tell the intrinsics of a camera; empty where they do. A fit that is far from
// its end has residuals that say nothing of that: they are taken to be of `kMostNoise` at the most.
std::string why_open(const Camera& camera, const Eigen::MatrixXd& covariance, double rms) {
  constexpr double kMostNoise = 1;  // px
  constexpr double kWorst = 0.1;    // of the focal length, of the width of the image
  const double less = std::min(1.0, kMostNoise / std::max(rms, kMostNoise));
  const auto sigma = [&](Eigen::Index i) { return less * std::sqrt(covariance(i, i)); };
  for (int i = 0; i < 2; ++i) {
    const double part = sigma(i) / camera.parameters()[static_cast<std::size_t>(i)];
    if (!(part < kWorst)) {
      return "its views do not tell its focal length: tilt the board by 20 to 45 degrees, to all "
             "sides, and let it come near";
    }
    if (!(sigma(2 + i) < kWorst * camera.image_size().width)) {
      return "its views do not tell its principal point: tilt the board to all sides, and turn it";
    }
  }
  return {};
}

// Holds cameras whose intrinsics the views leave open. Whether there was one more.
bool hold_open_ones(const JointProblem& problem, const std::vector<Camera>& cameras,
                    const RigFit& fit, FreeIntrinsics& free, std::vector<std::string>& remarks) {
  const std::vector<ParameterRange> ranges = ranges_of(cameras);
  bool any = false;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (!free.is_free[c]) continue;
    const std::string why =
        why_open(cameras[c], covariance_of(free, *fit.intrinsics, ranges[c]), fit.rms);
    if (why.empty()) continue;
    remarks.push_back(
        fmt::format("The intrinsics of '{}' stay as they are: {}.", problem.names[c], why));
    free.is_free[c] = false;
    any = true;
  }
  return any;
}

// The largest, in sigmas.
double length_of(const IntrinsicsStep& step) {
  double largest = 0;
  for (Eigen::Index i = 0; i < step.step.size(); ++i) {
    largest = std::max(largest, std::abs(step.step[i]) / std::sqrt(step.of_z(i, i)));
  }
  return largest;
}

// Where steps of Gauss-Newton lead to, from the last two of them: what views tell badly takes steps
// that shrink slowly, or turn round each time (D. G. Anderson, Iterative procedures for nonlinear
// integral equations, J. ACM 12(4), 1965, with one step before).
class StepMixing {
 public:
  // What `z` is to be moved by.
  Eigen::VectorXd next(const Eigen::VectorXd& z, const IntrinsicsStep& now) {
    constexpr double kFarthest = 10;  // times a step
    Eigen::VectorXd mixed = now.step;
    if (last_.size() == now.step.size()) {
      const Eigen::VectorXd change = now.step - last_;
      const Eigen::VectorXd in_sigmas = change.cwiseQuotient(now.of_z.diagonal());
      const double square = change.dot(in_sigmas);
      const double back = square > 0 ? now.step.dot(in_sigmas) / square : 0;
      mixed -= std::clamp(back, -kFarthest, 1.0) * (z - before_ + change);
    }
    last_ = now.step;
    before_ = z;
    return mixed;
  }

 private:
  Eigen::VectorXd last_;    // step
  Eigen::VectorXd before_;  // where it was found
};

// The corners of views in use.
std::vector<Pixel> corners_of(const JointSolve& one, std::size_t camera) {
  const std::set<std::size_t> rejected(one.fit.rejected.begin(), one.fit.rejected.end());
  std::vector<Pixel> corners;
  for (const PlacedView& placed : one.fit.places.views) {
    const BoardView& view = one.views[placed.view];
    if (view.of.camera != camera || rejected.contains(placed.view)) continue;
    corners.insert(corners.end(), view.seen.uv.begin(), view.seen.uv.end());
  }
  return corners;
}

Calibration calibration_of(const Calibration& known, const Camera& camera,
                           const Eigen::MatrixXd& covariance, const JointSolve& one,
                           std::size_t c) {
  Calibration found = camera.to_calibration();
  std::vector<Eigen::Index> estimated;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (!(covariance(i, i) > 0)) continue;
    estimated.push_back(i);
    found.parameters[static_cast<std::size_t>(i)].sigma = std::sqrt(covariance(i, i));
  }
  for (const Eigen::Index i : estimated) {
    for (const Eigen::Index j : estimated) found.covariance.push_back(covariance(i, j));
  }
  found.camera = known.camera;
  found.board = known.board;
  found.sensor_crop = known.sensor_crop;
  found.device = known.device;
  found.focus = known.focus;
  found.zoom = known.zoom;
  found.systematic = known.systematic;
  found.rms = one.fit.camera_rms[c];
  found.covered = convex_hull(corners_of(one, c));
  if (const auto promise = promise_of(found)) {
    found.expected_error = promise->covered;
    found.expected_error_anywhere = promise->anywhere;
    found.worst_place = promise->worst;
  }
  return found;
}

// What the views make of the intrinsics, against what was known of them.
void add_contradictions(const JointProblem& problem, const FreeIntrinsics& free,
                        const std::vector<ParameterRange>& ranges,
                        std::vector<std::string>& remarks) {
  constexpr double kFar = 5;  // sigmas
  for (std::size_t c = 0; c < ranges.size(); ++c) {
    double far = 0;
    for (Eigen::Index i = 0; i < free.z.size(); ++i) {
      const auto own = free.directions.col(i).segment(ranges[c].first, ranges[c].count);
      if (!own.isZero(0)) far = std::max(far, std::abs(free.z[i]));
    }
    if (far < kFar) continue;
    remarks.push_back(fmt::format(
        "The views contradict what the calibration of '{}' says of its lens by {:.0f} sigmas: it "
        "was moved, or the file is too sure of itself. Calibrate the camera again, or let these "
        "views alone tell.",
        problem.names[c], far));
  }
}

LensSolve finished(const JointProblem& problem, BoardsSolve solved, const FreeIntrinsics& free,
                   std::vector<Camera> cameras, std::vector<std::string> remarks) {
  LensSolve all = {std::move(solved), std::move(cameras), {}, std::move(remarks)};
  const std::vector<ParameterRange> ranges = ranges_of(all.cameras);
  const JointSolve& one = all.boards.joint;
  for (std::size_t c = 0; c < all.cameras.size(); ++c) {
    const Calibration& known = problem.seen[c].calibration;
    all.calibrations.push_back(
        free.is_free[c]
            ? calibration_of(known, all.cameras[c],
                             covariance_of(free, *one.fit.intrinsics, ranges[c]), one, c)
            : known);
  }
  return all;
}

std::vector<std::string> held_without_sigmas(const JointProblem& problem,
                                             const FreeIntrinsics& free) {
  std::vector<std::string> remarks;
  for (std::size_t c = 0; c < free.is_free.size(); ++c) {
    if (free.is_free[c]) continue;
    remarks.push_back(fmt::format(
        "The intrinsics of '{}' stay as they are: its calibration does not say how well they are "
        "known. Take one of calibsolve's, or let these views alone tell.",
        problem.names[c]));
  }
  return remarks;
}

}  // namespace

Result<BoardsSolve> solve_places(JointProblem problem, bool are_fixed,
                                 const std::stop_token& stop) {
  if (are_fixed) return solve_with_boards(problem, stop);
  auto joint = solve_with_clocks(std::move(problem), stop);
  if (!joint) return tl::unexpected<Error>(joint.error());
  return BoardsSolve{*std::move(joint), {}};
}

Result<LensSolve> solve_with_lenses(const JointProblem& problem, bool has_prior, bool are_fixed,
                                    const std::stop_token& stop) {
  constexpr double kSettled = 0.02;  // sigmas
  constexpr int kRounds = 40;
  const auto start = [&](std::vector<bool> may_be_free) {
    return free_intrinsics(problem.seen, problem.cameras, std::move(may_be_free), has_prior);
  };
  std::vector<Camera> cameras = problem.cameras;
  FreeIntrinsics free = start(std::vector<bool>(cameras.size(), true));
  std::vector<std::string> remarks = held_without_sigmas(problem, free);
  StepMixing mixing;
  for (int round = 0; round < kRounds; ++round) {
    const JointProblem now = {problem.seen,
                              cameras,
                              problem.views,
                              problem.names,
                              problem.tolerance,
                              problem.instants,
                              {&free, problem.wishes.world}};
    auto solved = solve_places(now, are_fixed, stop);
    if (!solved) return tl::unexpected<Error>(solved.error());
    const RigFit& fit = solved->joint.fit;
    if (hold_open_ones(problem, cameras, fit, free, remarks)) {
      cameras = problem.cameras;
      free = start(free.is_free);
      mixing = {};
      continue;
    }
    if (length_of(*fit.intrinsics) < kSettled) {
      if (has_prior) add_contradictions(problem, free, ranges_of(cameras), remarks);
      return finished(problem, *std::move(solved), free, std::move(cameras), std::move(remarks));
    }
    free.z += mixing.next(free.z, *fit.intrinsics);
    auto moved = cameras_at(free, problem.cameras);
    if (!moved) break;
    cameras = *std::move(moved);
  }
  return make_error(ErrorCode::kDegenerate,
                    "The intrinsics of the cameras come to no end together with the places: show "
                    "the board in more places and tilts, or let the intrinsics stay as they are.");
}

}  // namespace calvin::rig
