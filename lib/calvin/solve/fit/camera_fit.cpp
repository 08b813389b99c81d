// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Follows starts to their optima and keeps the best optimum.

#include "calvin/solve/fit/camera_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/fit/fit_steps.hpp"
#include "calvin/solve/start/bundle_adjustment.hpp"
#include "calvin/solve/start/pose_fit.hpp"
#include "calvin/solve/start/start_search.hpp"

namespace calvin {

namespace {

// Optima whose costs differ by a smaller part are the same.
constexpr double kSame = 1e-6;

// The squares of distances, their weights taken off, px^2.
std::vector<double> squares(const std::vector<double>& weight, const double* distance) {
  std::vector<double> result(weight.size());
  for (std::size_t i = 0; i < weight.size(); ++i) {
    const double d = distance[i] / weight[i];
    result[i] = d * d;
  }
  return result;
}

class FitRun {
 public:
  FitRun(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
         const Parameterization& parameterization, const SolveOptions& options,
         const std::stop_token& stop)
      : views_(views_of(std::move(views), shape)),
        adjustment_(parameterization, size, stop),
        search_(adjustment_, parameterization, shape, size),
        steps_(views_, shape, parameterization, options, adjustment_, search_) {
    for (const FitView& view : views_) all_.push_back(&view);
  }

  Fit run() {
    Candidate quick = search_.quick(all_);
    FitState state;
    if (std::isfinite(quick.scale)) state = steps_.solve_from(std::move(quick), kNearLambda);
    keep_rival(state);
    if (!sure(state) && !adjustment_.cancelled()) state = best_of_starts(std::move(state));
    if (state.converged && all_.size() < kFewViews) state = best_of_tilts(std::move(state));
    if (!adjustment_.cancelled()) return finish(std::move(state));
    Fit fit;
    fit.cancelled = true;
    return fit;
  }

 private:
  static std::vector<FitView> views_of(std::vector<PointSet> sets, const BoardShape& shape) {
    std::vector<FitView> views;
    views.reserve(sets.size());
    for (PointSet& set : sets) views.emplace_back(std::move(set), shape, last_of(views));
    return views;
  }

  [[nodiscard]] bool good(const FitState& state) const {
    return state.sound && !search_.is_far(state.scale);
  }

  // Whether no other start can lead to a better optimum. The optima of few views lie apart by as
  // much as their focal lengths are uncertain: no other was ever found where they are not.
  [[nodiscard]] bool sure(const FitState& state) const {
    constexpr double kCertain = 5e-3;  // of the focal length
    return good(state) && (all_.size() >= kFewViews || state.focal_sigma < kCertain);
  }

  // Follows every start that may be right; the best result, `best` being one of them.
  FitState best_of_starts(FitState best) {
    std::vector<Candidate> starts = search_.thorough(all_);
    // With many views the likeliest start is nearly always right.
    constexpr std::size_t kPlenty = 2;
    if (!search_.many_basins(all_) && !search_.is_rich() && starts.size() > kPlenty) {
      starts.resize(kPlenty);
    }
    for (Candidate& start : starts) {
      if (adjustment_.cancelled()) break;
      FitState state = steps_.solve_from(std::move(start), kFarLambda);
      keep_rival(state);
      if (better(state, best)) best = std::move(state);
      if (good(best) && !search_.many_basins(all_)) break;
    }
    return best;
  }

  // Tries the mirrored tilt of each view: a board that is small or hardly tilted fits nearly as
  // well in it, and few views do not tell which pose is wrong.
  FitState best_of_tilts(FitState best) {
    for (std::size_t v = 0; v < views_.size() && !adjustment_.cancelled(); ++v) {
      if (!best.used[v] || !mirrored_fits(best, v)) continue;
      Estimate start = best.at;
      start.poses[v] = mirrored_tilt(views_[v].set, *start.poses[v]);
      FitState state = steps_.solve_for(std::move(start), best.masks, kFarLambda);
      keep_rival(state);
      if (better(state, best)) best = std::move(state);
    }
    return best;
  }

  // Whether a view fits not much worse in the mirrored tilt, before the same camera.
  [[nodiscard]] bool mirrored_fits(const FitState& state, std::size_t v) const {
    const double much_worse = sure(state) ? 3 : 10;  // ratio of the costs
    const auto camera = adjustment_.camera(state.at.shared);
    const auto fit = camera ? fit_pose(state.views[v]->set, *camera, Loss{}) : std::nullopt;
    return fit && fit->other_cost < much_worse * fit->cost;
  }

  // Keeps a sound result as a possible rival of the best; two results of one cost are the same.
  void keep_rival(const FitState& state) {
    if (!state.sound) return;
    const double cost = state.problem->cost();
    const auto same = [&](const Rival& r) { return std::abs(r.cost - cost) <= kSame * cost; };
    if (std::none_of(optima_.begin(), optima_.end(), same))
      optima_.push_back({state.at.shared, cost});
  }

  // Takes the result apart; the run is over.
  Fit finish(FitState state) {
    Fit fit;
    fit.iterations = adjustment_.iterations();
    state.used.resize(views_.size(), false);
    std::size_t corner = 0;  // index among the corners of all views
    for (std::size_t v = 0; v < views_.size(); ++v) {
      fit.camera_from_board.push_back(state.used[v] ? *state.at.poses[v] : SE3{});
      // Corners that were left out have their squares too.
      fit.squares.emplace_back();
      if (state.used[v]) fit.squares[v] = squares(views_[v].set.weight, &state.distances[corner]);
      corner += views_[v].set.size();
    }
    fit.shared = std::move(state.at.shared);
    fit.used = state.used;
    fit.views = take_views(state);
    if (!state.problem) return fit;
    fit.cost = state.problem->cost();
    fit.converged = state.converged && state.information.size() > 0;
    fit.sound = state.sound;
    fit.information = std::move(state.information);
    // A rival without a corner that the best has costs less and is none; one with a corner that is
    // an outlier of the best costs more by so much that it is too unlikely to count.
    for (Rival& rival : optima_) {
      if (rival.cost > (1 + kSame) * fit.cost) fit.rivals.push_back(std::move(rival));
    }
    return fit;
  }

  // Moves the views out of a state that needs them no more.
  std::vector<PointSet> take_views(FitState& state) {
    std::vector<PointSet> taken;
    taken.reserve(state.views.size());
    auto masked = state.masked.begin();
    for (std::size_t v = 0; v < state.views.size(); ++v) {
      FitView& view = state.views[v] == &views_[v] ? views_[v] : *masked++;
      taken.push_back(std::move(view.set));
    }
    return taken;
  }

  std::vector<FitView> views_;
  std::vector<const FitView*> all_;
  BundleAdjustment adjustment_;
  StartSearch search_;
  FitSteps steps_;
  std::vector<Rival> optima_;  // what the starts led to
};

}  // namespace

Fit fit_camera(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
               const Parameterization& parameterization, const SolveOptions& options,
               const std::stop_token& stop) {
  return FitRun(std::move(views), shape, size, parameterization, options, stop).run();
}

}  // namespace calvin
