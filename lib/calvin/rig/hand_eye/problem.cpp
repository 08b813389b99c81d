// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rows of corners and of loops as the normal equations of an arrowhead problem.

#include "calvin/rig/hand_eye/problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/solve/linear/arrow_step.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

namespace {

constexpr int kPose = ArrowLayout::kPose;
constexpr int kFirstPlace = kPose + 1;  // of the columns of a loop, behind the residual

// The places are free, and the scale where it may be; the intrinsics are not.
Eigen::MatrixXd basis_of(int intrinsics, bool free_scale) {
  const int free = free_scale ? kPlaceColumns : kScaleColumn;
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(intrinsics + kPlaceColumns, free);
  for (int i = 0; i < free; ++i) basis(intrinsics + i, i) = 1;
  return basis;
}

Matrix6d block_of(const ArrowEquations& equations, std::size_t block) {
  using Rows = Eigen::Matrix<double, kPose, kPose, Eigen::RowMajor>;
  const Matrix6d lower = Eigen::Map<const Rows>(equations.own(block));
  return lower.selfadjointView<Eigen::Lower>();
}

}  // namespace

HandEyeProblem::HandEyeProblem(const Camera& camera, std::vector<HandEyeBlock> blocks,
                               EyeSetup setup, const LoopWeights& weights, bool free_scale,
                               HandEyePoint start)
    : blocks_(std::move(blocks)),
      setup_(setup),
      weights_(weights),
      table_(table_of({camera})),
      values_(values_of_cameras(table_, {camera})),
      basis_(basis_of(table_.count(), free_scale)),
      plan_(table_, 0, 0),
      place_columns_({{table_.count(), kPlaceColumns}}),
      elimination_({table_.count() + kPlaceColumns, blocks_.size(), 0}),
      current_{start, ArrowEquations({table_.count() + kPlaceColumns, blocks_.size(), 0}), {}, 0},
      trial_{std::move(start), ArrowEquations(current_.equations.layout()), {}, 0} {
  plan_.set(values_);
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

bool HandEyeProblem::linearise(State& state) {
  using Products = Eigen::Matrix<double, WeightedRows::ColsAtCompileTime,
                                 WeightedRows::ColsAtCompileTime, Eigen::RowMajor>;
  state.equations.clear();
  state.squares.clear();
  state.cost = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const RowSums sums = plan_.fill(*blocks_[b].seen, state.point.camera_from_board[b], Loss{});
    if (!sums.valid) return false;
    state.cost += sums.cost;
    plan_.add_pose(b, nullptr, state.equations);
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
  trial_.point.places = moved(current_.point.places, &step->move[first_place()]);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    trial_.point.camera_from_board[b] =
        retract(current_.point.camera_from_board[b], &block_steps_[kPose * b]);
  }
  return step->predicted;
}

std::optional<double> HandEyeProblem::evaluate_trial() {
  if (!(trial_.point.places.scale > 0) || !linearise(trial_)) return std::nullopt;
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

std::optional<LoopSums> HandEyeProblem::redundancy() {
  if (!elimination_.eliminate(current_.equations, 0)) return std::nullopt;
  const Eigen::Index free = basis_.cols();
  const auto covariance = scaled_solve(restrict_to(basis_, elimination_.schur()),
                                       Eigen::MatrixXd::Identity(free, free), kLeastPivot);
  if (!covariance) return std::nullopt;
  LoopSums sums;
  const auto stride = static_cast<Eigen::Index>(current_.equations.layout().stride());
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    using Cross = Eigen::Matrix<double, kPose, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Cross> cross(current_.equations.cross(b), kPose, stride);
    const Matrix6d own = block_of(current_.equations, b);
    const WeightedRows rows = weighted_rows(current_.point, b);
    // The pose of the view follows the places by -own^-1 cross, and has noise of its own.
    const Eigen::MatrixXd follow = solve_symmetric(own, cross.middleCols(1 + first_place(), free));
    const Eigen::MatrixXd by_places =
        rows.middleCols(kFirstPlace, free) - rows.leftCols<kPose>() * follow;
    const Eigen::MatrixXd by_pose = rows.leftCols<kPose>();
    const Eigen::MatrixXd fitted = congruent(*covariance, by_places.transpose()) +
                                   product(by_pose, solve_symmetric(own, by_pose.transpose()));
    sums.turn += 3 - fitted.diagonal().head<3>().sum();
    sums.place += 3 - fitted.diagonal().tail<3>().sum();
  }
  return sums;
}

}  // namespace calvin::rig
