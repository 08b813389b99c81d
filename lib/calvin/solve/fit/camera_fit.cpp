// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Follows starts to their optima, leaves out outliers on the way, and keeps the best optimum.

#include "calvin/solve/fit/camera_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/outliers.hpp"
#include "calvin/solve/start/least_squares.hpp"
#include "calvin/solve/start/plane_pose.hpp"
#include "calvin/solve/start/pose_fit.hpp"
#include "calvin/solve/start/start_search.hpp"

namespace calvin {

namespace {

// The last step's predicted decrease, relative to the cost: a smaller decrease is rounding.
constexpr double kTolerance = 1e-13;

// A predicted decrease, in variances of a corner: the square of 1e-3 sigma, so that a step with a
// smaller decrease moves no parameter by more than that.
constexpr double kSmall = 1e-6;

// The damping where the start is likely near the optimum, and where it may be anywhere.
constexpr double kNearLambda = 1e-8;
constexpr double kFarLambda = 1e-4;

// Optima whose costs differ by a smaller part are the same.
constexpr double kSame = 1e-6;

// The state of the fit from one start: how far it has come, and in the end its result.
struct FitState {
  std::vector<double> shared;
  Poses poses;                           // of all views that have one
  std::optional<BundleProblem> problem;  // over the views in use; refers to `views`
  std::vector<ViewMask> masks;
  std::vector<const FitView*> views;  // without the corners that are masked
  std::vector<FitView> masked;        // the views of which corners are left out
  std::vector<bool> used;
  bool converged = false;
  bool sound = false;             // converged, every unknown is determined, every corner seen
  Eigen::MatrixXd information;    // of the directions of the problem, poses eliminated
  std::vector<double> distances;  // of all corners from where they belong, px
  double scale = std::numeric_limits<double>::infinity();  // robust_scale() of the distances, px
};

Eigen::Vector3d center_of(const PointSet& view) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : view.points) sum += p;
  return sum / static_cast<double>(view.size());
}

// A few thousand values evenly spread: their median is as good as that of all.
std::vector<double> subsample(const std::vector<double>& values) {
  constexpr std::size_t kMany = 4096;
  const std::size_t step = values.size() / kMany + 1;
  std::vector<double> some;
  some.reserve(values.size() / step + 1);
  for (std::size_t i = 0; i < values.size(); i += step) some.push_back(values[i]);
  return some;
}

// Whether `a` is a better result than `b`.
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

class FitRun {
 public:
  FitRun(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
         const Parameterization& parameterization, const SolveOptions& options,
         const std::stop_token& stop)
      : shape_(shape),
        parameterization_(parameterization),
        options_(options),
        least_squares_(parameterization, size, stop),
        search_(least_squares_, parameterization, shape, size) {
    views_.reserve(views.size());
    for (PointSet& view : views) views_.emplace_back(std::move(view), shape, last_of(views_));
    for (const FitView& view : views_) all_.push_back(&view);
  }

  Fit run() {
    Candidate quick = search_.quick(all_);
    lambda_ = kNearLambda;
    if (std::isfinite(quick.scale)) solve_from(std::move(quick));
    lambda_ = kFarLambda;
    if (!good(state_) && !least_squares_.cancelled()) try_starts();
    if (!least_squares_.cancelled()) return finish();
    Fit fit;
    fit.cancelled = true;
    return fit;
  }

 private:
  [[nodiscard]] bool good(const FitState& state) const {
    return state.sound && !search_.is_far(state.scale);
  }

  // Follows every start that may be right and keeps the best result.
  void try_starts() {
    FitState best = std::move(state_);
    std::vector<Candidate> starts = search_.thorough(all_);
    // With many views the likeliest start is nearly always right.
    constexpr std::size_t kPlenty = 2;
    if (!search_.many_basins(all_) && !search_.is_rich() && starts.size() > kPlenty) {
      starts.resize(kPlenty);
    }
    for (Candidate& start : starts) {
      if (least_squares_.cancelled()) break;
      solve_from(std::move(start));
      keep_rival();
      if (better(state_, best)) std::swap(state_, best);
      if (good(best) && !search_.many_basins(all_)) break;
    }
    state_ = std::move(best);
    if (state_.converged && all_.size() < kFewViews) mirror_views();
  }

  // Tries the mirrored tilt of each view: a board that is small or hardly tilted fits nearly as
  // well in it, and few views do not tell which pose is wrong.
  void mirror_views() {
    for (std::size_t v = 0; v < views_.size() && !least_squares_.cancelled(); ++v) {
      if (!state_.used[v] || !mirrored_fits(v)) continue;
      FitState before = std::exchange(state_, {});
      state_.shared = before.shared;
      state_.poses = before.poses;
      state_.poses[v] = mirrored_tilt(*state_.poses[v], center_of(views_[v].set));
      solve_masked(before.masks);
      measure();
      keep_rival();
      if (!better(state_, before)) state_ = std::move(before);
    }
  }

  // Whether a view fits not much worse in the mirrored tilt, before the same camera.
  bool mirrored_fits(std::size_t v) {
    constexpr double kMuchWorse = 10;  // ratio of the costs
    const auto camera = least_squares_.camera(state_.shared);
    const auto fit = camera ? fit_pose(state_.views[v]->set, *camera, Loss{}) : std::nullopt;
    return fit && fit->other_cost < kMuchWorse * fit->cost;
  }

  // Keeps a sound result as a possible rival of the best; two results of one cost are the same.
  void keep_rival() {
    if (!state_.sound) return;
    const double cost = state_.problem->cost();
    const auto same = [&](const Rival& r) { return std::abs(r.cost - cost) <= kSame * cost; };
    if (std::none_of(optima_.begin(), optima_.end(), same))
      optima_.push_back({state_.shared, cost});
  }

  // Solves from a start, without the outliers that show on the way.
  void solve_from(Candidate start) {
    state_ = FitState();
    state_.shared = std::move(start.shared);
    state_.poses = std::move(start.poses);
    fit_inliers(options_.reject_outliers ? robust_fit() : all_corners());
    if (!least_squares_.cancelled()) measure();
  }

  void measure() {
    state_.distances = distances();
    state_.scale = robust_scale(subsample(state_.distances));
    state_.sound = state_.converged && sound();
  }

  bool sound() {
    const auto reduced = state_.problem->reduced();
    if (!reduced) return false;
    state_.information = reduced->information;
    const Eigen::Index n = state_.information.rows();
    if (!scaled_solve(state_.information, Eigen::MatrixXd::Identity(n, n), kLeastPivot))
      return false;
    return !search_.is_rich() || sees_corners();
  }

  // Whether every corner in use has a projection: a rational lens may have a pole between two
  // corners.
  [[nodiscard]] bool sees_corners() const {
    const auto camera = least_squares_.camera(state_.shared);
    if (!camera) return false;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (!state_.used[v]) continue;
      const PointSet& view = state_.views[v]->set;
      for (std::size_t i = 0; i < view.size(); ++i) {
        if (view.weight[i] > 0 && !camera->project(*state_.poses[v] * view.points[i])) return false;
      }
    }
    return true;
  }

  [[nodiscard]] std::vector<ViewMask> all_corners() const {
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
  std::vector<ViewMask> robust_fit() {
    if (least_squares_.cancelled()) return {};
    robust_step(Loss::Kind::kHuber, 1e-5);
    if (least_squares_.cancelled()) return {};
    std::vector<ViewMask> masks = find_masks();
    if (!any_outlier(masks)) return masks;
    robust_step(Loss::Kind::kHuber, 1e-8);
    robust_step(Loss::Kind::kCauchy, 1e-8);
    return find_masks();
  }

  // The distances of all corners from where the state puts them, px.
  std::vector<double> distances() {
    std::vector<double> all;
    all.reserve(views_.empty() ? 0 : views_.size() * views_.front().set.size());
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const auto d = least_squares_.distances(views_[v], state_.shared, state_.poses[v]);
      all.insert(all.end(), d.begin(), d.end());
    }
    return all;
  }

  void robust_step(Loss::Kind kind, double tolerance) {
    const Loss loss{kind, 2.5 * robust_scale(distances())};
    (void)least_squares_.minimise_over(all_, state_.shared, state_.poses, parameterization_.basis,
                                       loss, {options_.max_iterations, tolerance, 0, lambda_});
  }

  // The outliers in this state. A view that looks wrong gets a second chance from a fresh pose,
  // because its own may have been drawn into the mirrored tilt; so does a view without a pose.
  std::vector<ViewMask> find_masks() {
    std::vector<std::vector<double>> distances;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      distances.push_back(least_squares_.distances(views_[v], state_.shared, state_.poses[v]));
    }
    std::vector<ViewMask> masks = find_outliers(distances);
    const auto camera = least_squares_.camera(state_.shared);
    pose_moved_ = false;
    for (std::size_t v = 0; camera && v < views_.size() && !least_squares_.cancelled(); ++v) {
      if (state_.poses[v] && (masks[v].view || !options_.reject_outliers)) continue;
      const auto fit = fit_pose(views_[v].set, *camera, {Loss::Kind::kHuber, 1});
      if (!fit) continue;
      auto fresh = least_squares_.distances(views_[v], state_.shared, fit->camera_from_board);
      if (!(robust_scale(fresh) < 0.99 * robust_scale(distances[v]))) continue;
      state_.poses[v] = fit->camera_from_board;
      distances[v] = std::move(fresh);
      pose_moved_ = true;
    }
    return pose_moved_ ? find_outliers(distances) : masks;
  }

  // The final least squares without the outliers, which are judged anew by its result.
  void fit_inliers(std::vector<ViewMask> masks) {
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds && !least_squares_.cancelled(); ++round) {
      solve_masked(masks);
      if (!state_.problem || round + 1 == kRounds) return;
      const bool all_posed = std::all_of(state_.poses.begin(), state_.poses.end(),
                                         [](const auto& pose) { return pose.has_value(); });
      if (!options_.reject_outliers && all_posed) return;
      std::vector<ViewMask> next = find_masks();
      if (!options_.reject_outliers) next = masks;
      if (next == masks && !pose_moved_) return;
      masks = std::move(next);
    }
  }

  // The view without the corners that are masked: the same one where none is.
  const FitView& masked(const FitView& view, const ViewMask& mask) {
    bool same = true;
    for (std::size_t i = 0; i < mask.corners.size(); ++i) {
      same = same && mask.corners[i] == (view.set.weight[i] > 0);
    }
    if (same) return view;
    PointSet set = view.set;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (!mask.corners[i]) set.weight[i] = 0;
    }
    return state_.masked.emplace_back(std::move(set), shape_, &view);
  }

  void solve_masked(const std::vector<ViewMask>& masks) {
    state_.masks = masks;
    state_.views.clear();
    state_.masked.clear();
    state_.masked.reserve(views_.size());
    std::vector<const FitView*> views;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const FitView& view = masked(views_[v], masks[v]);
      state_.views.push_back(&view);
      views.push_back(masks[v].view && spans_plane(view.set) ? &view : nullptr);
    }
    // The basin of a rich lens is long and bent: one run of the iteration may end half way.
    const int runs = search_.is_rich() ? 3 : 1;
    for (int run_number = 0; run_number < runs; ++run_number) {
      state_.problem =
          least_squares_.minimise_over(views, state_.shared, state_.poses, parameterization_.basis,
                                       Loss{}, final_options(views));
      state_.converged = state_.problem && least_squares_.converged();
      if (!state_.problem || state_.converged || least_squares_.cancelled()) break;
    }
    state_.used.assign(views_.size(), false);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      state_.used[v] = state_.problem && views[v] != nullptr && state_.poses[v];
    }
  }

  [[nodiscard]] LmOptions final_options(const std::vector<const FitView*>& views) const {
    std::size_t corners = 0;
    for (const FitView* view : views) corners += view == nullptr ? 0 : view->points.count();
    const double residuals = std::max(1.0, 2 * static_cast<double>(corners));
    return {options_.max_iterations, kTolerance, kSmall / residuals, lambda_};
  }

  // The squares of distances, their weights taken off, px^2.
  static std::vector<double> squares(const std::vector<double>& weight, const double* distance) {
    std::vector<double> result(weight.size());
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const double d = distance[i] / weight[i];
      result[i] = d * d;
    }
    return result;
  }

  Fit finish() {
    Fit fit;
    fit.iterations = least_squares_.iterations();
    state_.used.resize(views_.size(), false);
    std::size_t corner = 0;  // index among the corners of all views
    for (std::size_t v = 0; v < views_.size(); ++v) {
      fit.camera_from_board.push_back(state_.used[v] ? *state_.poses[v] : SE3{});
      // Corners that were left out have their squares too.
      fit.squares.emplace_back();
      if (state_.used[v]) fit.squares[v] = squares(views_[v].set.weight, &state_.distances[corner]);
      corner += views_[v].set.size();
    }
    fit.shared = std::move(state_.shared);
    fit.used = state_.used;
    fit.views = take_views();
    if (!state_.problem) return fit;
    fit.cost = state_.problem->cost();
    fit.converged = state_.converged && state_.information.size() > 0;
    fit.sound = state_.sound;
    fit.information = std::move(state_.information);
    // A rival without a corner that the best has costs less and is none; one with a corner that is
    // an outlier of the best costs more by so much that it is too unlikely to count.
    for (Rival& rival : optima_) {
      if (rival.cost > (1 + kSame) * fit.cost) fit.rivals.push_back(std::move(rival));
    }
    return fit;
  }

  // Moves the views out of the state, which needs them no more.
  std::vector<PointSet> take_views() {
    std::vector<PointSet> taken;
    taken.reserve(state_.views.size());
    auto masked = state_.masked.begin();
    for (std::size_t v = 0; v < state_.views.size(); ++v) {
      FitView& view = state_.views[v] == &views_[v] ? views_[v] : *masked++;
      taken.push_back(std::move(view.set));
    }
    return taken;
  }

  const BoardShape& shape_;
  const Parameterization& parameterization_;
  const SolveOptions& options_;
  LeastSquares least_squares_;
  StartSearch search_;

  std::vector<FitView> views_;
  std::vector<const FitView*> all_;
  std::vector<Rival> optima_;
  FitState state_;
  bool pose_moved_ = false;  // whether the last find_masks() moved a pose
  double lambda_ = kFarLambda;
};

}  // namespace

Fit fit_camera(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
               const Parameterization& parameterization, const SolveOptions& options,
               const std::stop_token& stop) {
  return FitRun(std::move(views), shape, size, parameterization, options, stop).run();
}

}  // namespace calvin
