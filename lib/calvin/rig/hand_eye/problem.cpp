// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rows of corners and of loops as the normal equations of an arrowhead problem.

#include "calvin/rig/hand_eye/problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/solve/linear/arrow_step.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

namespace {

// What is free of the table, the places, and the scale where it may be.
Eigen::MatrixXd basis_of(const ParameterTable& table, int free_places) {
  const Eigen::MatrixXd own = table.basis();
  Eigen::MatrixXd basis =
      Eigen::MatrixXd::Zero(own.rows() + kPlaceColumns, own.cols() + free_places);
  basis.topLeftCorner(own.rows(), own.cols()) = own;
  for (int i = 0; i < free_places; ++i) basis(own.rows() + i, own.cols() + i) = 1;
  return basis;
}

Matrix6d block_of(const ArrowEquations& equations, std::size_t block) {
  using Rows = Eigen::Matrix<double, kPose, kPose, Eigen::RowMajor>;
  const Matrix6d lower = Eigen::Map<const Rows>(equations.own(block));
  return lower.selfadjointView<Eigen::Lower>();
}

}  // namespace

HandEyeProblem::HandEyeProblem(ParameterTable table, std::vector<HandEyeBlock> blocks,
                               EyeSetup setup, const LoopWeights& weights, bool free_scale,
                               HandEyePoint start)
    : table_(std::move(table)),
      blocks_(std::move(blocks)),
      setup_(setup),
      weights_(weights),
      free_scale_(free_scale),
      basis_(basis_of(table_, free_places())),
      place_columns_({{table_.count(), kPlaceColumns}}),
      elimination_({table_.count() + kPlaceColumns, blocks_.size(), 0}),
      current_{start, ArrowEquations({table_.count() + kPlaceColumns, blocks_.size(), 0}), {}, 0},
      trial_{std::move(start), ArrowEquations(current_.equations.layout()), {}, 0} {
  for (std::size_t c = 0; c < table_.cameras(); ++c) plans_.emplace_back(table_, c, 0);
  valid_ = linearise(current_);
}

HandEyeProblem::WeightedRows HandEyeProblem::weighted_rows(const HandEyePoint& point,
                                                           std::size_t block) const {
  const LoopRows loop = loop_rows(point.places, setup_, point.camera_from_board[block],
                                  blocks_[block].base_from_hand);
  WeightedRows rows;
  rows << loop.by_board, loop.error, loop.by_places;
  rows.topRows<3>() *= weights_.turn;
  rows.bottomRows<3>() *= weights_.place;
  return rows;
}

bool HandEyeProblem::add_corners(std::size_t block, State& state) {
  const SE3& first_from_board = state.point.camera_from_board[block];
  for (const SeenByCamera& seen : blocks_[block].seen) {
    const SE3& from_first = state.point.camera_from_first[seen.camera];
    RowPlan& plan = plans_[seen.camera];
    const RowSums sums = plan.fill(*seen.points, from_first * first_from_board, Loss{});
    if (!sums.valid) return false;
    state.cost += sums.cost;
    plan.add_pose(block, seen.camera == 0 ? nullptr : &from_first, state.equations);
  }
  return true;
}

bool HandEyeProblem::linearise(State& state) {
  using Products = Eigen::Matrix<double, WeightedRows::ColsAtCompileTime,
                                 WeightedRows::ColsAtCompileTime, Eigen::RowMajor>;
  state.equations.clear();
  state.squares.clear();
  state.cost = 0;
  for (RowPlan& plan : plans_) plan.set(state.point.shared);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (!add_corners(b, state)) return false;
    const WeightedRows rows = weighted_rows(state.point, b);
    const Products products = rows.transpose() * rows;
    state.equations.add(b, place_columns_, products.data(), products.cols());
    state.squares.push_back(
        {rows.col(kPose).head<3>().squaredNorm(), rows.col(kPose).tail<3>().squaredNorm()});
    state.cost += state.squares.back().turn + state.squares.back().place;
  }
  return std::isfinite(state.cost);
}

std::optional<double> HandEyeProblem::propose(double lambda) {
  const auto step = arrow_step(current_.equations, elimination_, basis_, lambda, block_steps_);
  if (!step) return std::nullopt;
  const HandEyePoint& from = current_.point;
  HandEyePoint& to = trial_.point;
  to.places = moved(from.places, &step->move[first_place()]);
  for (std::size_t i = 0; i < to.shared.size(); ++i) {
    to.shared[i] = from.shared[i] + step->move[static_cast<Eigen::Index>(i)];
  }
  for (std::size_t c = 0; c < table_.cameras(); ++c) {
    const ParameterRange range = table_.rig_pose(c);
    if (range.empty()) continue;
    to.camera_from_first[c] = retract(from.camera_from_first[c], &step->move[range.first]);
    std::fill_n(to.shared.begin() + range.first, range.count, 0.0);
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    to.camera_from_board[b] = retract(from.camera_from_board[b], &block_steps_[kPose * b]);
  }
  return step->predicted;
}

std::optional<double> HandEyeProblem::evaluate_trial() {
  if (!(trial_.point.places.scale > 0)) return std::nullopt;
  for (std::size_t c = 0; c < table_.cameras(); ++c) {
    for (const double f : values_of(trial_.point.shared, table_.focal(c))) {
      if (!(f > 0)) return std::nullopt;
    }
  }
  if (!linearise(trial_)) return std::nullopt;
  return trial_.cost;
}

void HandEyeProblem::accept_unseen(double predicted) {
  std::swap(current_.point, trial_.point);
  current_.cost = std::max(0.0, current_.cost - predicted);
}

std::optional<Eigen::MatrixXd> HandEyeProblem::information() {
  if (!elimination_.eliminate(current_.equations, 0)) return std::nullopt;
  const Eigen::Index all = basis_.rows();
  return restrict_to(Eigen::MatrixXd::Identity(all, all), elimination_.schur());
}

std::optional<Eigen::MatrixXd> HandEyeProblem::covariance() {
  if (!elimination_.eliminate(current_.equations, 0)) return std::nullopt;
  const Eigen::Index free = basis_.cols();
  const auto inverse = scaled_solve(restrict_to(basis_, elimination_.schur()),
                                    Eigen::MatrixXd::Identity(free, free), kLeastPivot);
  if (!inverse) return std::nullopt;
  return congruent(*inverse, basis_.transpose());
}

std::optional<LoopSums> HandEyeProblem::redundancy() {
  const auto shared = covariance();
  if (!shared) return std::nullopt;
  LoopSums sums;
  const auto stride = static_cast<Eigen::Index>(current_.equations.layout().stride());
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    using Cross = Eigen::Matrix<double, kPose, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Cross> cross(current_.equations.cross(b), kPose, stride);
    const Matrix6d own = block_of(current_.equations, b);
    const WeightedRows rows = weighted_rows(current_.point, b);
    // The pose of the board follows what is shared by -own^-1 cross, and has noise of its own.
    const Eigen::MatrixXd by_pose = rows.leftCols<kPose>();
    Eigen::MatrixXd by_shared =
        -product(by_pose, solve_symmetric(own, cross.middleCols(1, shared->rows())));
    by_shared.rightCols<kPlaceColumns>() += rows.rightCols<kPlaceColumns>();
    const Eigen::MatrixXd fitted = congruent(*shared, by_shared.transpose()) +
                                   product(by_pose, solve_symmetric(own, by_pose.transpose()));
    sums.turn += 3 - fitted.diagonal().head<3>().sum();
    sums.place += 3 - fitted.diagonal().tail<3>().sum();
  }
  return sums;
}

}  // namespace calvin::rig
