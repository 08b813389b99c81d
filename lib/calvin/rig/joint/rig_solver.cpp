// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Least squares over all places, what is left out of it, and how it moves with what is seen.

#include "calvin/rig/joint/rig_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/solve/linear/lm.hpp"

namespace calvin::rig {

namespace {

constexpr double kMedianDistance = 1.17741;  // of two normal coordinates, in their sigma
// To where it can be told what contradicts the rest: a step that would change the cost by less than
// this part of it is the last one.
constexpr LmOptions kRough = {100, 1e-13, 1e-3, 1e-6};
// From there to the optimum, where the last step is too small to change the equations.
constexpr LmOptions kFine = {100, 1e-13, 1e-11, 1e-6};

}  // namespace

tl::unexpected<Error> undetermined_places() {
  return make_error(ErrorCode::kDegenerate,
                    "What the cameras have seen does not determine where they stand: show the "
                    "board to two cameras at a time in more places.");
}

RigSolver::RigSolver(const std::vector<BoardView>& views, RigPlaces places,
                     const std::vector<Camera>& cameras, const std::stop_token& stop)
    : views_(views),
      places_(std::move(places)),
      cameras_(cameras),
      stop_(stop),
      table_(table_of_places(cameras)) {
  lenses_ = points_before(cameras);
  all_.reserve(places_.views.size());
  points_.resize(places_.views.size());
  for (std::size_t p = 0; p < places_.views.size(); ++p) {
    const PlacedView& placed = places_.views[p];
    const PointSet& seen = views[placed.view].seen;
    weights_.push_back(seen.weight);
    const ViewPoints* last = all_.empty() ? nullptr : &all_.back();
    const bool is_own =
        placed.board_from_own.rotation.isIdentity(0) && placed.board_from_own.translation.isZero(0);
    if (is_own) {
      all_.emplace_back(seen, BoardShape(), last);
    } else {
      all_.emplace_back(set_of(p), BoardShape(), last);
    }
  }
}

Status RigSolver::run() {
  constexpr double kSoft = 5;  // px: places are known about
  constexpr int kRounds = 3;
  if (!minimise_over(Loss{Loss::Kind::kCauchy, kSoft}, kRough, false)) return undetermined_places();
  for (int round = 0; round < kRounds; ++round) {
    const bool changed = leave_out();
    if (!minimise_over(Loss{}, kFine, !changed)) return undetermined_places();
    if (!changed) break;
  }
  if (stop_.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  return {};
}

bool RigSolver::is_used(std::size_t placed) const {
  return std::ranges::any_of(weights_[placed], [](double w) { return w > 0; });
}

std::optional<BundleProblem::Reduced> RigSolver::equations_over(const ParameterTable& table) {
  return problem(table, Loss{}).reduced();
}

std::optional<BundleProblem::PoseEquations> RigSolver::pose_equations(std::size_t pose,
                                                                      const ParameterTable& table) {
  const BundleProblem over = problem(table, Loss{});
  if (!over.valid() || !numbers_[pose]) return std::nullopt;
  return over.pose_equations(*numbers_[pose]);
}

double RigSolver::variance() const {
  double corners = 0;
  for (const auto& view : weights_) {
    corners += static_cast<double>(std::ranges::count_if(view, [](double w) { return w > 0; }));
  }
  const auto free =
      static_cast<double>(kPose) * static_cast<double>(used_poses() + cameras_.size() - 1);
  return optimum_->cost() / std::max(2 * corners - free, 1.0);
}

std::size_t RigSolver::used_poses() const {
  std::vector<bool> used(places_.rig_from_board.size(), false);
  for (std::size_t p = 0; p < places_.views.size(); ++p) {
    if (is_used(p)) used[places_.views[p].pose] = true;
  }
  return static_cast<std::size_t>(std::ranges::count(used, true));
}

// Poses that nothing is seen of any more are no unknowns.
BundleProblem RigSolver::problem(const ParameterTable& table, const Loss& loss) {
  BundlePoint start;
  start.shared = values_of_cameras(table, cameras_);
  start.camera_from_rig = places_.camera_from_rig;
  ResidualBlocks blocks;
  numbers_.assign(places_.rig_from_board.size(), std::nullopt);
  for (std::size_t p = 0; p < all_.size(); ++p) {
    if (!is_used(p)) continue;
    auto& number = numbers_[places_.views[p].pose];
    if (!number) {
      number = start.rig_from_board.size();
      start.rig_from_board.push_back(places_.rig_from_board[places_.views[p].pose]);
    }
    blocks.boards.push_back({points_[p] ? &*points_[p] : &all_[p], *number,
                             views_[places_.views[p].view].of.camera, 0});
  }
  return BundleProblem(std::move(blocks), {&table, table.basis(), {}}, std::move(start), loss,
                       stop_);
}

// From the problem of the last time where that `goes_on`, with the same corners.
bool RigSolver::minimise_over(const Loss& loss, const LmOptions& options, bool goes_on) {
  if (goes_on) {
    if (!optimum_->restart(loss)) return false;
  } else if (!optimum_.emplace(problem(table_, loss)).valid()) {
    return false;
  }
  BundleProblem& fit = *optimum_;
  (void)minimise(fit, options, stop_);
  places_.camera_from_rig = fit.point().camera_from_rig;
  for (std::size_t pose = 0; pose < numbers_.size(); ++pose) {
    if (numbers_[pose]) places_.rig_from_board[pose] = fit.point().rig_from_board[*numbers_[pose]];
  }
  return true;
}

RigSolver::Squares RigSolver::squares() const {
  Squares all;
  all.reserve(all_.size());
  std::size_t longest = 0;
  for (const ViewPoints& view : all_) longest = std::max(longest, view.padded());
  const AlignedArray squares = aligned_array(longest);
  for (std::size_t p = 0; p < all_.size(); ++p) {
    const PlacedView& placed = places_.views[p];
    const std::vector<double>& weight = views_[placed.view].seen.weight;
    const std::size_t camera = views_[placed.view].of.camera;
    lenses_[camera].squares(all_[p],
                            places_.camera_from_rig[camera] * places_.rig_from_board[placed.pose],
                            squares.get());
    if (all_[p].count() == weight.size()) {
      all.emplace_back(squares.get(), squares.get() + weight.size());
      continue;
    }
    std::vector<double>& own = all.emplace_back(weight.size(), 0.0);
    std::size_t used = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      if (weight[i] > 0) own[i] = squares[used++];
    }
  }
  return all;
}

// px^2, per coordinate, of the corners in use.
double RigSolver::variance_of(const Squares& squares) const {
  std::size_t corners = 0;
  for (const auto& view : squares) corners += view.size();
  std::vector<double> used;
  used.reserve(corners);
  for (std::size_t p = 0; p < squares.size(); ++p) {
    for (std::size_t i = 0; i < squares[p].size(); ++i) {
      if (weights_[p][i] > 0) used.push_back(squares[p][i]);
    }
  }
  if (used.empty()) return 0;
  const auto middle = used.begin() + static_cast<std::ptrdiff_t>(used.size() / 2);
  std::ranges::nth_element(used, middle);
  return *middle / (kMedianDistance * kMedianDistance);
}

// The weights of a view without those of corners that contradict the others, or of all.
std::vector<double> RigSolver::kept(std::size_t p, const std::vector<double>& squares,
                                    double variance) const {
  constexpr double kFarCorner = 6;  // sigmas
  constexpr double kFarView = 5;
  constexpr std::size_t kFewest = 4;
  const double far_corner = kFarCorner * kFarCorner * variance;
  const double far_middle = kFarView * kFarView * kMedianDistance * kMedianDistance * variance;
  std::vector<double> now = views_[places_.views[p].view].seen.weight;
  if (squares.empty() || std::ranges::max(squares) <= std::min(far_corner, far_middle)) return now;
  std::vector<double> sorted = squares;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  std::size_t left = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (*middle > far_middle || squares[i] > far_corner) now[i] = 0;
    left += now[i] > 0 ? 1 : 0;
  }
  if (left < kFewest) now.assign(now.size(), 0.0);
  return now;
}

// Views that contradict the others, and single corners. Whether any were left out that were not
// before, or the other way round.
bool RigSolver::leave_out() {
  const Squares all = squares();
  const double variance = variance_of(all);
  bool changed = false;
  for (std::size_t p = 0; p < all_.size(); ++p) {
    std::vector<double> now = kept(p, all[p], variance);
    if (now == weights_[p]) continue;
    changed = true;
    weights_[p] = std::move(now);
    points_[p].emplace(set_of(p), BoardShape());
  }
  return changed;
}

Eigen::VectorXd RigSolver::residuals() const {
  std::vector<double> all;
  for (std::size_t p = 0; p < all_.size(); ++p) {
    const PointSet set = set_of(p);
    const PlacedView& placed = places_.views[p];
    const Camera& camera = cameras_[views_[placed.view].of.camera];
    const SE3 to_camera = places_.camera_from_rig[views_[placed.view].of.camera] *
                          places_.rig_from_board[placed.pose];
    for (std::size_t i = 0; i < set.size(); ++i) {
      const double weight = set.weight[i];
      if (!(weight > 0)) continue;
      const auto at = camera.project(to_camera * set.points[i]);
      all.push_back(at ? weight * (at->u - set.uv[i].u) : 0);
      all.push_back(at ? weight * (at->v - set.uv[i].v) : 0);
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

// The corners in use of a placed view, with the labels of its board, where they are seen now.
PointSet RigSolver::set_of(std::size_t p) const {
  const PlacedView& placed = places_.views[p];
  PointSet set = views_[placed.view].seen;
  for (Eigen::Vector3d& point : set.points) point = placed.board_from_own * point;
  set.weight = weights_[p];
  if (ways_ == nullptr || p >= ways_->size()) return set;
  for (std::size_t i = 0; i < (*ways_)[p].size(); ++i) {
    set.uv[i].u += (*ways_)[p][i].u;
    set.uv[i].v += (*ways_)[p][i].v;
  }
  return set;
}

std::optional<RigSolver::Optimum> RigSolver::refit(const std::vector<std::vector<Pixel>>& ways) {
  const RigPlaces kept = places_;
  const auto see = [&](const std::vector<std::vector<Pixel>>* now) {
    ways_ = now;
    for (std::size_t p = 0; p < ways.size(); ++p) {
      if (!ways[p].empty()) points_[p].emplace(set_of(p), BoardShape());
    }
  };
  see(&ways);
  std::optional<Optimum> found;
  if (minimise_over(Loss{}, LmOptions{}, false)) {
    found = Optimum{places_.camera_from_rig, residuals()};
  }
  see(nullptr);
  places_ = kept;
  return found;
}

}  // namespace calvin::rig
