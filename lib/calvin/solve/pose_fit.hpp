// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One pose by least squares, for a camera model and its bare parameters. Internal.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "calvin/solve/lm.hpp"
#include "calvin/solve/plane_pose.hpp"
#include "calvin/solve/reprojection.hpp"

namespace calvin {

// The unit rays of the corners in use, camera frame; zero where the model has none.
template <typename M>
std::vector<Eigen::Vector3d> rays_of(const PointSet& view, const double* parameters, double skew) {
  using Lens = typename M::Lens;
  const double limit = Lens::limit(parameters + 4);
  std::vector<Eigen::Vector3d> rays(view.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    double xy[2];
    xy[1] = (view.uv[i].v - parameters[3]) / parameters[1];
    xy[0] = (view.uv[i].u - parameters[2] - skew * xy[1]) / parameters[0];
    const auto ray = Lens::undistort(parameters + 4, limit, xy);
    if (ray && ray->allFinite()) rays[i] = *ray;
  }
  return rays;
}

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
    Eigen::Matrix<double, 6, 6> block = current_.equations.pose();
    const Eigen::Matrix<double, 6, 1> diagonal = block.diagonal();
    block.diagonal() *= 1 + lambda;
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> cholesky(block);
    if (cholesky.info() != Eigen::Success) return std::nullopt;
    const Eigen::Matrix<double, 6, 1> gradient = current_.equations.pose_gradient();
    const Eigen::Matrix<double, 6, 1> step = -cholesky.solve(gradient);
    const double predicted = lambda * step.dot(diagonal.cwiseProduct(step)) - gradient.dot(step);
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

struct PoseFit {
  SE3 camera_from_board;
  double cost = 0;        // px^2
  double other_cost = 0;  // px^2, of the mirrored tilt
};

// The better of the two minima. Absent where the view determines no pose.
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
