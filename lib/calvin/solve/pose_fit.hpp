// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One pose by least squares, for a camera model and its bare parameters. Internal.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "calvin/solve/fit.hpp"
#include "calvin/solve/lm.hpp"
#include "calvin/solve/plane_pose.hpp"
#include "calvin/solve/rays.hpp"
#include "calvin/solve/reprojection.hpp"

namespace calvin {

// The pose of one view as a problem for minimise().
template <typename M>
class PoseProblem {
 public:
  PoseProblem(const PointSet& view, const double* parameters, double skew, Loss loss,
              const SE3& start)
      : view_(view), parameters_(parameters), reprojection_(loss, skew), current_{start, {}} {
    valid_ = linearise(current_);
  }

  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] double cost() const { return current_.equations.cost; }
  [[nodiscard]] const SE3& pose() const { return current_.pose; }

  [[nodiscard]] std::optional<double> propose(double lambda) {
    const Matrix6 block = current_.equations.pose();
    const auto factor = pose_factor(block, lambda);
    if (!factor) return std::nullopt;
    const Vector6 gradient = current_.equations.pose_gradient();
    Vector6 step = -gradient;
    solve_lower(*factor, step);
    solve_upper(*factor, step);
    const double predicted =
        lambda * step.dot(block.diagonal().cwiseProduct(step)) - gradient.dot(step);
    if (!std::isfinite(predicted)) return std::nullopt;
    trial_.pose = moved(current_.pose, step);
    return std::max(predicted, 0.0);
  }
  [[nodiscard]] std::optional<double> evaluate_trial() {
    if (!linearise(trial_)) return std::nullopt;
    return trial_.equations.cost;
  }
  void accept() { std::swap(current_, trial_); }

 private:
  struct State {
    SE3 pose;
    ViewEquations<M> equations;
  };
  bool linearise(State& state) {
    return reprojection_.evaluate(view_, parameters_, state.pose, state.equations);
  }

  const PointSet& view_;
  const double* parameters_;
  Reprojection<M> reprojection_;
  State current_;
  State trial_;
  bool valid_ = false;
};

template <typename M>
std::optional<PoseFit> fit_pose(const PointSet& view, const double* parameters, double skew,
                                Loss loss) {
  const auto start = pose_from_rays(view.points, rays_of<M>(view, parameters, skew));
  if (!start) return std::nullopt;
  const auto refined = [&](const SE3& from) -> std::optional<PoseFit> {
    PoseProblem<M> problem(view, parameters, skew, loss, from);
    if (!problem.valid()) return std::nullopt;
    minimise(problem, LmOptions{}, {});
    return PoseFit{problem.pose(), problem.cost(), problem.cost()};
  };
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : view.points) center += p / static_cast<double>(view.size());
  auto best = refined(*start);
  auto other = refined(mirrored_tilt(best ? best->camera_from_board : *start, center));
  if (other && (!best || other->cost < best->cost)) std::swap(best, other);
  if (best && other) best->other_cost = other->cost;
  return best;
}

}  // namespace calvin
