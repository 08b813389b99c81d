// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The arrowhead problem: camera parameters shared by all views, one pose per view. Internal.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/solve/lm.hpp"
#include "calvin/solve/pose_block.hpp"
#include "calvin/solve/reprojection.hpp"
#include "calvin/solve/scaled_solve.hpp"

namespace calvin {

template <typename M>
struct CameraAndPoses {
  std::array<double, M::kCount> parameters{};
  std::vector<SE3> camera_from_board;
};

// Each pose is eliminated by the Cholesky factor of its 6x6 block; what is left is a system over
// the shared block alone (Schur complement), so that the cost of a step grows with the number of
// views and not faster. The Jacobian is never stored, its products per view are.
template <typename M>
class Arrowhead {
 public:
  static constexpr int kShared = M::kCount;
  using Point = CameraAndPoses<M>;
  using Basis = Eigen::Matrix<double, kShared, Eigen::Dynamic>;

  // `views` and the poses of `start` correspond; the views stay where they are until the last
  // evaluation. The parameters move in the span of `basis` only.
  Arrowhead(std::vector<const PointSet*> views, Point start, Basis basis, Loss loss)
      : views_(std::move(views)), basis_(std::move(basis)), reprojection_(loss) {
    current_.point = std::move(start);
    trial_.point = current_.point;
    whitened_.resize(views_.size());
    factors_.resize(views_.size());
    valid_ = linearise(current_);
  }

  // False where a point has no projection at the start: nothing can be minimised.
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] double cost() const { return current_.cost; }
  [[nodiscard]] const Point& point() const { return current_.point; }

  [[nodiscard]] std::optional<double> propose(double lambda) {
    if (!eliminate_poses(lambda)) return std::nullopt;
    const auto step = shared_step(lambda);
    if (!step) return std::nullopt;
    const Shared move = basis_ * *step;
    double predicted = -current_.gradient.dot(move);
    predicted += lambda * step->dot(damping_.cwiseProduct(*step));
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const auto& equations = current_.views[v];
      Vector6 x = whitened_[v].col(kShared) + whitened_[v].template leftCols<kShared>() * move;
      solve_upper(factors_[v], x);
      predicted += equations.pose_gradient().dot(x);
      predicted += lambda * x.dot(equations.pose().diagonal().cwiseProduct(x));
      trial_.point.camera_from_board[v] = moved(current_.point.camera_from_board[v], -x);
    }
    for (int i = 0; i < kShared; ++i) {
      const auto k = static_cast<std::size_t>(i);
      trial_.point.parameters[k] = current_.point.parameters[k] + move[i];
    }
    if (!std::isfinite(predicted)) return std::nullopt;
    return std::max(predicted, 0.0);
  }

  [[nodiscard]] std::optional<double> evaluate_trial() {
    if (!(trial_.point.parameters[0] > 0) || !(trial_.point.parameters[1] > 0)) return std::nullopt;
    if (!linearise(trial_)) return std::nullopt;
    return trial_.cost;
  }

  void accept() { std::swap(current_, trial_); }

  // The inverse of the marginal covariance of the basis coefficients, for residuals of 1 px:
  // the Schur complement without damping. Absent where a pose is not determined.
  [[nodiscard]] std::optional<Eigen::MatrixXd> information() {
    if (!eliminate_poses(0)) return std::nullopt;
    return restrict_to(basis_, schur_);
  }

 private:
  using Shared = Eigen::Matrix<double, kShared, 1>;
  using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;

  struct State {
    Point point;
    std::vector<ViewEquations<M>> views;
    SharedMatrix normal;  // lower triangle
    Shared gradient;
    double cost = 0;
  };

  bool linearise(State& state) {
    state.views.resize(views_.size());
    state.normal.setZero();
    state.gradient.setZero();
    state.cost = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      auto& equations = state.views[v];
      if (!reprojection_.evaluate(*views_[v], state.point.parameters.data(),
                                  state.point.camera_from_board[v], equations)) {
        return false;
      }
      state.normal += equations.shared();
      state.gradient += equations.shared_gradient();
      state.cost += equations.cost;
    }
    return std::isfinite(state.cost);
  }

  // Fills factors_, whitened_ = L^-1 [cross^T | gradient] per view, and the Schur complement.
  bool eliminate_poses(double lambda) {
    schur_ = current_.normal;
    reduced_gradient_ = current_.gradient;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const auto& equations = current_.views[v];
      const auto factor = pose_factor(equations.pose(), lambda);
      if (!factor) return false;
      factors_[v] = *factor;
      auto& w = whitened_[v];
      w.template leftCols<kShared>() = equations.cross().transpose();
      w.col(kShared) = equations.pose_gradient();
      solve_lower(factors_[v], w);
      const auto c = w.template leftCols<kShared>();
      schur_.noalias() -= c.transpose().lazyProduct(c);
      reduced_gradient_.noalias() -= c.transpose().lazyProduct(w.col(kShared));
    }
    return true;
  }

  std::optional<Eigen::VectorXd> shared_step(double lambda) {
    damping_ = restrict_to(basis_, current_.normal).diagonal();
    Eigen::MatrixXd s = restrict_to(basis_, schur_);
    s.diagonal() += lambda * damping_;
    const auto step = scaled_solve(s, -basis_.transpose().lazyProduct(reduced_gradient_), 0);
    if (!step) return std::nullopt;
    return step->col(0);
  }

  std::vector<const PointSet*> views_;
  Basis basis_;
  Reprojection<M> reprojection_;
  State current_;
  State trial_;
  bool valid_ = false;

  std::vector<Matrix6> factors_;
  std::vector<Eigen::Matrix<double, 6, kShared + 1>> whitened_;
  SharedMatrix schur_;  // lower triangle is valid
  Shared reduced_gradient_;
  Eigen::VectorXd damping_;
};

}  // namespace calvin
