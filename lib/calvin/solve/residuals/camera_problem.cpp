// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The normal equations of a camera and its poses, and the damped steps that they give.

#include "calvin/solve/residuals/camera_problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/linear/products.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

ArrowLayout arrow_layout(const RowLayout& rows, std::size_t blocks) {
  return {RowLayout::kPose, rows.shared(), blocks};
}

std::size_t products_stride(const RowLayout& rows) {
  return (static_cast<std::size_t>(rows.columns()) + kLanes - 1) / kLanes * kLanes;
}

}  // namespace

SE3 retract(const SE3& pose, const double* d) {
  const Eigen::Matrix3d turn = exp_so3({d[0], d[1], d[2]});
  return {turn * pose.rotation, turn * pose.translation + Eigen::Vector3d(d[3], d[4], d[5])};
}

CameraProblem::CameraProblem(std::vector<const ViewPoints*> views, SharedUnknowns unknowns,
                             CameraPoint start, const Loss& loss, std::stop_token stop)
    : views_(std::move(views)),
      unknowns_(std::move(unknowns)),
      fill_(fill_rows_of(unknowns_.table->model(0))),
      loss_(loss),
      stop_(std::move(stop)),
      rows_(row_layout(*unknowns_.table, 0, 0)),
      elimination_(arrow_layout(layout(), views_.size())),
      current_{start, ArrowEquations(arrow_layout(layout(), views_.size())), 0},
      trial_{std::move(start), ArrowEquations(arrow_layout(layout(), views_.size())), 0},
      products_(
          aligned_array(static_cast<std::size_t>(layout().columns()) * products_stride(layout()))) {
  valid_ = linearise(current_);
}

bool CameraProblem::linearise(State& state) {
  const RowPoint at = row_point(*unknowns_.table, 0, 0, state.point.shared);
  state.equations.clear();
  state.cost = 0;
  constexpr std::size_t kViewsAtOnce = 64;  // between looks at the stop token; some 0.1 ms
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (v % kViewsAtOnce == kViewsAtOnce - 1 && stop_.stop_requested()) return false;
    rows_.resize(views_[v]->padded());
    const RowSums sums = fill_(*views_[v], at, state.point.camera_from_board[v], loss_, rows_);
    if (!sums.valid) return false;
    state.cost += sums.cost;
    column_products(rows_.data(), 2 * rows_.padded(), layout().columns(), products_.get(),
                    products_stride(layout()));
    state.equations.add(v, products_.get(), products_stride(layout()));
  }
  for (const ParameterTable::Prior& prior : unknowns_.priors) {
    const double information = 1 / (prior.sigma * prior.sigma);
    const double off = state.point.shared[static_cast<std::size_t>(prior.unknown)] - prior.value;
    state.equations.add_prior(prior.unknown, information, information * off);
    state.cost += information * off * off;
  }
  return std::isfinite(state.cost);
}

std::optional<Eigen::VectorXd> CameraProblem::shared_step(double lambda) {
  const Eigen::MatrixXd& basis = unknowns_.basis;
  const Eigen::Index n = basis.rows();
  Eigen::MatrixXd normal(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) normal(i, j) = current_.equations.shared(i, j);
  }
  damping_ = restrict_to(basis, normal).diagonal();
  Eigen::MatrixXd s = restrict_to(basis, elimination_.schur());
  s.diagonal() += lambda * damping_;
  const auto step =
      scaled_solve(s, -basis.transpose().lazyProduct(elimination_.reduced_gradient()), 0);
  if (!step) return std::nullopt;
  return step->col(0);
}

std::optional<double> CameraProblem::propose(double lambda) {
  if (!elimination_.eliminate(current_.equations, lambda)) return std::nullopt;
  const auto step = shared_step(lambda);
  if (!step) return std::nullopt;
  const Eigen::VectorXd move = unknowns_.basis.lazyProduct(*step);
  double predicted = lambda * step->dot(damping_.cwiseProduct(*step));
  for (int i = 0; i < move.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    predicted -= current_.equations.shared_gradient(i) * move[i];
    trial_.point.shared[k] = current_.point.shared[k] + move[i];
  }
  const std::size_t stride = current_.equations.layout().stride();
  for (std::size_t v = 0; v < views_.size(); ++v) {
    double d[RowLayout::kPose];
    elimination_.block_step(v, move, d);
    const double* own = current_.equations.own(v);
    const double* cross = current_.equations.cross(v);
    for (std::size_t i = 0; i < RowLayout::kPose; ++i) {
      predicted += d[i] * (lambda * own[i * RowLayout::kPose + i] * d[i] - cross[i * stride]);
    }
    trial_.point.camera_from_board[v] = retract(current_.point.camera_from_board[v], d);
  }
  if (!std::isfinite(predicted)) return std::nullopt;
  return std::max(predicted, 0.0);
}

std::optional<double> CameraProblem::evaluate_trial() {
  for (const double f : values_of(trial_.point.shared, unknowns_.table->focal(0))) {
    if (!(f > 0)) return std::nullopt;
  }
  if (!linearise(trial_)) return std::nullopt;
  return trial_.cost;
}

std::optional<CameraProblem::Reduced> CameraProblem::reduced() {
  if (!elimination_.eliminate(current_.equations, 0)) return std::nullopt;
  return Reduced{restrict_to(unknowns_.basis, elimination_.schur()),
                 unknowns_.basis.transpose().lazyProduct(elimination_.reduced_gradient()),
                 elimination_.reduced_cost()};
}

}  // namespace calvin
