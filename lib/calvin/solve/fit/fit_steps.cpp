// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Follows one start to its optimum: a robust fit, then least squares without outliers, judged anew.

#include "calvin/solve/fit/fit_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/start/pose_fit.hpp"

namespace calvin {

namespace {

// The last step's predicted decrease, relative to the cost: a smaller decrease is rounding.
constexpr double kTolerance = 1e-13;

// A predicted decrease, in variances of a corner: the square of 1e-3 sigma, so that a step with a
// smaller decrease moves no parameter by more than that.
constexpr double kSmallDecrease = 1e-6;

// The median of as many values is as good as that of all.
constexpr std::size_t kMany = 4096;

// Values evenly spread.
std::vector<double> subsample(const std::vector<double>& values) {
  const std::size_t step = values.size() / kMany + 1;
  std::vector<double> some;
  some.reserve(values.size() / step + 1);
  for (std::size_t i = 0; i < values.size(); i += step) some.push_back(values[i]);
  return some;
}

std::vector<double> joined(const std::vector<std::vector<double>>& lists) {
  std::vector<double> all;
  all.reserve(lists.empty() ? 0 : lists.size() * lists.front().size());
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace

bool better(const FitState& a, const FitState& b) {
  if (!std::isfinite(b.scale)) return std::isfinite(a.scale);
  if (a.sound != b.sound) return a.sound;
  if (a.converged != b.converged) return a.converged;
  if (a.converged && a.masks == b.masks) {
    const auto views = [](const FitState& e) {
      return std::count(e.used.begin(), e.used.end(), true);
    };
    if (views(a) != views(b)) return views(a) > views(b);
    return a.problem->cost() < b.problem->cost();
  }
  return trimmed_rms(a.distances) < trimmed_rms(b.distances);
}

FitSteps::FitSteps(const std::vector<FitView>& views, const BoardShape& shape,
                   const Parameterization& parameterization, const SolveOptions& options,
                   BundleAdjustment& adjustment, const StartSearch& search)
    : views_(views),
      shape_(shape),
      parameterization_(parameterization),
      options_(options),
      adjustment_(adjustment),
      search_(search) {
  for (const FitView& view : views) all_.push_back(&view);
}

FitState FitSteps::solve_from(Estimate start, double lambda) {
  FitState state =
      fit_inliers(options_.reject_outliers ? robust_fit(std::move(start), lambda)
                                           : Judgement{std::move(start), all_corners(), false, {}},
                  lambda);
  return adjustment_.cancelled() ? std::move(state) : measured(std::move(state));
}

FitState FitSteps::solve_for(Estimate start, const std::vector<ViewMask>& masks, double lambda) {
  return measured(solve_masked(std::move(start), masks, lambda));
}

FitState FitSteps::measured(FitState state) {
  if (state.distances.empty()) state.distances = joined(distances(state.at));
  state.scale = robust_scale(subsample(state.distances));
  if (!state.converged) return state;
  const auto reduced = state.problem->reduced();
  if (!reduced) return state;
  state.information = reduced->information;
  const Eigen::Index n = state.information.rows();
  const auto inverse =
      scaled_solve(state.information, Eigen::MatrixXd::Identity(n, n), kLeastPivot);
  if (!inverse) return state;
  state.focal_sigma = focal_sigma(state, *inverse);
  state.sound = !search_.is_rich() || sees_corners(state);
  return state;
}

double FitSteps::focal_sigma(const FitState& state, const Eigen::MatrixXd& inverse) const {
  double degrees = -static_cast<double>(inverse.rows());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (state.used[v]) degrees += 2 * static_cast<double>(state.views[v]->set.used()) - 6;
  }
  const double variance = state.problem->cost() / std::max(degrees, 1.0);
  const ParameterRange focal = parameterization_.table.focal(0);
  double largest = 0;
  for (int i = focal.first; i < focal.end(); ++i) {
    const Eigen::VectorXd by = parameterization_.basis.row(i);
    const double sigma = std::sqrt(variance * by.dot(inverse * by));
    largest = std::max(largest, sigma / state.at.shared[static_cast<std::size_t>(i)]);
  }
  return largest;
}

// Whether every corner in use has a projection: a rational lens may have a pole between two
// corners.
bool FitSteps::sees_corners(const FitState& state) const {
  const auto camera = adjustment_.camera(state.at.shared);
  if (!camera) return false;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (!state.used[v]) continue;
    const PointSet& view = state.views[v]->set;
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (view.weight[i] > 0 && !camera->project(*state.at.poses[v] * view.points[i])) return false;
    }
  }
  return true;
}

std::vector<ViewMask> FitSteps::all_corners() const {
  std::vector<ViewMask> masks;
  for (const FitView& view : views_) {
    ViewMask mask;
    for (const double w : view.set.weight) mask.corners.push_back(w > 0);
    masks.push_back(std::move(mask));
  }
  return masks;
}

// Finds outliers. Huber's loss bounds the pull of each corner whatever the start; Cauchy's loss
// then takes the pull of gross ones away.
FitSteps::Judgement FitSteps::robust_fit(Estimate at, double lambda) {
  if (adjustment_.cancelled()) return {};
  at = robust_step(std::move(at), Loss::Kind::kHuber, 1e-5, lambda);
  if (adjustment_.cancelled()) return {};
  Judgement judged = judge(std::move(at));
  if (!any_outlier(judged.masks)) return judged;
  at = robust_step(std::move(judged.at), Loss::Kind::kHuber, 1e-8, lambda);
  at = robust_step(std::move(at), Loss::Kind::kCauchy, 1e-8, lambda);
  return judge(std::move(at));
}

// The distances of the corners of each view from where an estimate puts them, px.
std::vector<std::vector<double>> FitSteps::distances(const Estimate& at) {
  std::vector<std::vector<double>> of_views;
  of_views.reserve(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    of_views.push_back(adjustment_.distances(views_[v], at.shared, at.poses[v]));
  }
  return of_views;
}

// robust_scale() of an estimate to some per cent, px; of many views only some are looked at.
double FitSteps::rough_scale(const Estimate& at) {
  constexpr std::size_t kEnough = 512;  // corners, of as many views at least:
  constexpr std::size_t kEnoughViews = 8;
  std::size_t corners = 0;
  for (const FitView& view : views_) corners += view.set.size();
  const std::size_t step =
      std::min(corners / kEnough + 1, std::max<std::size_t>(views_.size() / kEnoughViews, 1));
  std::vector<double> some;
  for (std::size_t v = 0; v < views_.size(); v += step) {
    const auto d = adjustment_.distances(views_[v], at.shared, at.poses[v]);
    some.insert(some.end(), d.begin(), d.end());
  }
  return robust_scale(std::move(some));
}

Estimate FitSteps::robust_step(Estimate at, Loss::Kind kind, double tolerance, double lambda) {
  // A step this small, as a part of the cost, leads so near to the optimum that corners are judged
  // there as they would be after another one; the final least squares goes on from it anyway.
  constexpr double kNear = 0.05;
  const Loss loss{kind, 2.5 * rough_scale(at)};
  return adjustment_
      .minimise_over(all_, std::move(at), parameterization_.basis, loss,
                     {options_.max_iterations, tolerance, kNear, lambda})
      .at;
}

// A view that looks wrong gets a second chance from a fresh pose, because its own may have been
// drawn into the mirrored tilt; so does a view without a pose.
FitSteps::Judgement FitSteps::judge(Estimate at) {
  Judgement result = {std::move(at), {}, false, {}};
  Poses& poses = result.at.poses;
  result.distances = distances(result.at);
  result.masks = find_outliers(result.distances);
  const auto camera = adjustment_.camera(result.at.shared);
  for (std::size_t v = 0; camera && v < views_.size() && !adjustment_.cancelled(); ++v) {
    if (poses[v] && result.masks[v].view) continue;
    const auto fit = fit_pose(views_[v].set, *camera, {Loss::Kind::kHuber, 1});
    if (!fit) continue;
    auto fresh = adjustment_.distances(views_[v], result.at.shared, fit->camera_from_board);
    if (!(robust_scale(fresh) < 0.99 * robust_scale(result.distances[v]))) continue;
    poses[v] = fit->camera_from_board;
    result.distances[v] = std::move(fresh);
    result.pose_moved = true;
  }
  if (result.pose_moved) result.masks = find_outliers(result.distances);
  return result;
}

// The final least squares without the outliers, which are judged anew by its result.
FitState FitSteps::fit_inliers(Judgement start, double lambda) {
  constexpr int kRounds = 4;
  FitState state;
  for (int round = 0; round < kRounds && !adjustment_.cancelled(); ++round) {
    state = solve_masked(std::move(start.at), std::move(start.masks), lambda);
    if (!state.problem || round + 1 == kRounds) break;
    start = judge(state.at);
    if (!options_.reject_outliers) start.masks = state.masks;
    if (start.masks != state.masks || start.pose_moved) continue;
    state.distances = joined(start.distances);
    break;
  }
  return state;
}

// The view without the corners that are masked, which the state keeps: the same view where none is.
const FitView& FitSteps::masked(const FitView& view, const ViewMask& mask, FitState& state) const {
  bool same = true;
  for (std::size_t i = 0; i < mask.corners.size(); ++i) {
    same = same && mask.corners[i] == (view.set.weight[i] > 0);
  }
  if (same) return view;
  PointSet set = view.set;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (!mask.corners[i]) set.weight[i] = 0;
  }
  return state.masked.emplace_back(std::move(set), shape_, &view);
}

FitState FitSteps::solve_masked(Estimate at, std::vector<ViewMask> masks, double lambda) {
  FitState state;
  state.at = std::move(at);
  state.masks = std::move(masks);
  state.masked.reserve(views_.size());
  std::vector<const FitView*> views;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const FitView& view = masked(views_[v], state.masks[v], state);
    state.views.push_back(&view);
    views.push_back(state.masks[v].view && spans_plane(view.set) ? &view : nullptr);
  }
  // The basin of a rich lens is long and bent: one run of the iteration may end half way.
  const int runs = search_.is_rich() ? 3 : 1;
  for (int run_number = 0; run_number < runs; ++run_number) {
    Minimum found = adjustment_.minimise_over(views, std::move(state.at), parameterization_.basis,
                                              Loss{}, final_options(views, lambda));
    state.at = std::move(found.at);
    state.problem = std::move(found.problem);
    state.converged = found.converged;
    if (!state.problem || state.converged || adjustment_.cancelled()) break;
  }
  state.used.assign(views_.size(), false);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    state.used[v] = state.problem && views[v] != nullptr && state.at.poses[v];
  }
  return state;
}

LmOptions FitSteps::final_options(const std::vector<const FitView*>& views, double lambda) const {
  std::size_t corners = 0;
  for (const FitView* view : views) corners += view == nullptr ? 0 : view->points.count();
  const double residuals = std::max(1.0, 2 * static_cast<double>(corners));
  return {options_.max_iterations, kTolerance, kSmallDecrease / residuals, lambda};
}

}  // namespace calvin
