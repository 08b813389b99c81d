// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The normal equations of all residual blocks, and the damped steps that they give.

#include "calvin/solve/residuals/bundle_problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "calvin/solve/linear/arrow_step.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

ArrowLayout arrow_layout(const ParameterTable& table, const BundlePoint& point) {
  return {table.count(), point.rig_from_board.size(), point.points.size()};
}

// The arrays of free points, which are placed anew in every state.
ViewPoints arrays_of(PointSet seen) {
  seen.points.assign(seen.ids.size(), Eigen::Vector3d::Zero());
  return {seen, BoardShape()};
}

// Whether each unknown of the table is one that the residuals depend on: a place in the rig wants a
// rig. With an unknown that shows in no residual nothing could be solved (a readout shows in those
// of boards that move, of which a single view need not be one); a block of a camera, board or pose
// that is not there could not be read.
bool fit_together(const ParameterTable& table, const ResidualBlocks& blocks,
                  const BundlePoint& point) {
  const std::size_t places = point.camera_from_rig.size();
  if (places != 0 && places != table.cameras()) return false;
  for (std::size_t c = 0; c < table.cameras(); ++c) {
    if (places == 0 && !table.rig_pose(c).empty()) return false;
  }
  return std::all_of(blocks.boards.begin(), blocks.boards.end(),
                     [&](const BoardResiduals& block) {
                       return block.camera < table.cameras() && block.board < table.boards() &&
                              block.pose < point.rig_from_board.size();
                     }) &&
         std::all_of(blocks.lines.begin(), blocks.lines.end(),
                     [&](std::size_t pose) { return pose < point.rig_from_board.size(); }) &&
         std::all_of(blocks.points.begin(), blocks.points.end(),
                     [&](const PointResiduals& block) { return block.camera < table.cameras(); });
}

}  // namespace

SE3 retract(const SE3& pose, const double* d) {
  const Eigen::Matrix3d turn = exp_so3({d[0], d[1], d[2]});
  return {turn * pose.rotation, turn * pose.translation + Eigen::Vector3d(d[3], d[4], d[5])};
}

BundleProblem::BundleProblem(ResidualBlocks blocks, SharedUnknowns unknowns, BundlePoint start,
                             const Loss& loss, std::stop_token stop)
    : blocks_(std::move(blocks)),
      unknowns_(std::move(unknowns)),
      loss_(loss),
      stop_(std::move(stop)),
      elimination_(arrow_layout(*unknowns_.table, start)),
      current_{start, ArrowEquations(arrow_layout(*unknowns_.table, start)), 0},
      trial_{std::move(start), ArrowEquations(current_.equations.layout()), 0} {
  if (!fit_together(*unknowns_.table, blocks_, current_.point)) return;
  plan_of_board_.reserve(blocks_.boards.size());
  for (const BoardResiduals& block : blocks_.boards) {
    plan_of_board_.push_back(plan_for(plans_, *unknowns_.table, block.camera, block.board));
  }
  for (const PointResiduals& block : blocks_.points) {
    plan_of_points_.push_back(plan_for(plans_, *unknowns_.table, block.camera, std::nullopt));
    points_.push_back(arrays_of(block.seen));
  }
  valid_ = linearise(current_);
}

bool BundleProblem::linearise(State& state) {
  state.equations.clear();
  state.cost = 0;
  for (RowPlan& plan : plans_) plan.set(state.point.shared);
  constexpr std::size_t kBlocksAtOnce = 64;  // between looks at the stop token; some 0.1 ms
  for (std::size_t b = 0; b < blocks_.boards.size(); ++b) {
    if (b % kBlocksAtOnce == kBlocksAtOnce - 1 && stop_.stop_requested()) return false;
    if (!add_board(blocks_.boards[b], plans_[plan_of_board_[b]], state)) return false;
  }
  for (std::size_t b = 0; b < blocks_.points.size(); ++b) {
    if (!add_points(b, state)) return false;
  }
  hold_turns(state);
  add_priors(state);
  return std::isfinite(state.cost);
}

bool BundleProblem::add_board(const BoardResiduals& block, RowPlan& plan, State& state) {
  const SE3& pose = state.point.rig_from_board[block.pose];
  const bool on_rig = !state.point.camera_from_rig.empty();
  const SE3* camera_from_rig = on_rig ? &state.point.camera_from_rig[block.camera] : nullptr;
  const RowSums sums = plan.fill(*block.seen, on_rig ? *camera_from_rig * pose : pose, loss_);
  if (!sums.valid) return false;
  state.cost += sums.cost;
  plan.add_pose(block.pose, camera_from_rig, state.equations);
  return true;
}

bool BundleProblem::add_points(std::size_t b, State& state) {
  const PointResiduals& block = blocks_.points[b];
  ViewPoints& view = points_[b];
  view.place(state.point.points);
  SE3 camera_from_world = block.rig_from_world;
  if (!state.point.camera_from_rig.empty()) {
    camera_from_world = state.point.camera_from_rig[block.camera] * camera_from_world;
  }
  RowPlan& plan = plans_[plan_of_points_[b]];
  const RowSums sums = plan.fill(view, camera_from_world, loss_);
  if (!sums.valid) return false;
  state.cost += sums.cost;
  const std::size_t first = state.point.rig_from_board.size();
  for (std::size_t i = 0; i < view.count(); ++i) {
    const std::size_t small = first + static_cast<std::size_t>(view.ids()[i]);
    plan.add_point(small, i, camera_from_world, state.equations);
  }
  return true;
}

// The motion n by which a line turns about itself is one along which nothing changes: the equations
// H of its pose have H n = 0, and are regular with n n^T added, of a weight like theirs.
void BundleProblem::hold_turns(State& state) const {
  constexpr int kPose = ArrowLayout::kPose;
  constexpr std::size_t kStride = kPose + 1;
  for (const std::size_t pose : blocks_.lines) {
    if (!state.equations.filled(pose)) continue;
    const SE3& rig_from_line = state.point.rig_from_board[pose];
    const Eigen::Vector3d axis = rig_from_line.rotation.col(0);
    Eigen::Matrix<double, kPose, 1> turn;
    turn << axis, rig_from_line.translation.cross(axis);
    double trace = 0;
    for (int i = 0; i < kPose; ++i) trace += state.equations.own(pose)[i * kPose + i];
    const double weight = trace / (kPose * turn.squaredNorm());
    // Behind the pose stands the residual, which is 0.
    Eigen::Matrix<double, kStride, kStride, Eigen::RowMajor> products =
        Eigen::Matrix<double, kStride, kStride, Eigen::RowMajor>::Zero();
    products.topLeftCorner<kPose, kPose>() = weight * turn * turn.transpose();
    state.equations.add(pose, ArrowColumns({}), products.data(), kStride);
  }
}

void BundleProblem::add_priors(State& state) const {
  for (const ParameterTable::Prior& prior : unknowns_.priors) {
    const double information = 1 / (prior.sigma * prior.sigma);
    const double off = state.point.shared[static_cast<std::size_t>(prior.unknown)] - prior.value;
    state.equations.add_prior(prior.unknown, information, information * off);
    state.cost += information * off * off;
  }
}

void BundleProblem::move_shared(const Eigen::VectorXd& move) {
  const BundlePoint& from = current_.point;
  BundlePoint& to = trial_.point;
  for (std::size_t i = 0; i < to.shared.size(); ++i) {
    to.shared[i] = from.shared[i] + move[static_cast<Eigen::Index>(i)];
  }
  for (std::size_t c = 0; c < to.camera_from_rig.size(); ++c) {
    const ParameterRange range = unknowns_.table->rig_pose(c);
    if (range.empty()) continue;
    to.camera_from_rig[c] = retract(from.camera_from_rig[c], &move[range.first]);
    std::fill_n(to.shared.begin() + range.first, range.count, 0.0);
  }
}

std::optional<double> BundleProblem::propose(double lambda) {
  const auto step =
      arrow_step(current_.equations, elimination_, unknowns_.basis, lambda, block_steps_);
  if (!step) return std::nullopt;
  move_shared(step->move);
  const ArrowLayout& layout = current_.equations.layout();
  const auto step_of = [&](std::size_t block) { return &block_steps_[ArrowLayout::kPose * block]; };
  for (std::size_t b = 0; b < layout.poses; ++b) {
    trial_.point.rig_from_board[b] = retract(current_.point.rig_from_board[b], step_of(b));
  }
  for (std::size_t p = 0; p < layout.points; ++p) {
    trial_.point.points[p] = current_.point.points[p] + Eigen::Vector3d(step_of(layout.poses + p));
  }
  return step->predicted;
}

std::optional<double> BundleProblem::evaluate_trial() {
  for (std::size_t c = 0; c < unknowns_.table->cameras(); ++c) {
    for (const double f : values_of(trial_.point.shared, unknowns_.table->focal(c))) {
      if (!(f > 0)) return std::nullopt;
    }
  }
  if (!linearise(trial_)) return std::nullopt;
  return trial_.cost;
}

std::optional<BundleProblem::Reduced> BundleProblem::reduced() {
  if (!elimination_.eliminate(current_.equations, 0)) return std::nullopt;
  return reduced_to(unknowns_.basis, elimination_);
}

BundleProblem::PoseEquations BundleProblem::pose_equations(std::size_t pose) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const ArrowEquations& equations = current_.equations;
  const ArrowLayout& layout = equations.layout();
  const Eigen::Map<const RowMajor> lower(equations.own(pose), ArrowLayout::kPose,
                                         ArrowLayout::kPose);
  const Eigen::Map<const RowMajor> rows(equations.cross(pose), ArrowLayout::kPose,
                                        static_cast<Eigen::Index>(layout.stride()));
  return {lower.selfadjointView<Eigen::Lower>(), rows.middleCols(1, layout.shared)};
}

BundleProblem::Reduced reduced_to(const Eigen::MatrixXd& basis,
                                  const ArrowElimination& elimination) {
  return {restrict_to(basis, elimination.schur()),
          basis.transpose().lazyProduct(elimination.reduced_gradient()),
          elimination.reduced_cost()};
}

}  // namespace calvin
