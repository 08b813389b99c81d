// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Follows starts to their optima, leaves out outliers on the way, and keeps the best optimum.

#include "calvin/solve/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "calvin/solve/least_squares.hpp"
#include "calvin/solve/outliers.hpp"
#include "calvin/solve/plane_pose.hpp"
#include "calvin/solve/pose_fit.hpp"
#include "calvin/solve/scaled_solve.hpp"
#include "calvin/solve/start_search.hpp"

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

// Where the path from one start ends, or has come to so far.
struct Ending {
  std::vector<double> shared;
  Poses poses;                           // of all views that have one
  std::optional<CameraProblem> problem;  // over the views in use; refers to `views`
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
std::vector<double> some_of(const std::vector<double>& values) {
  constexpr std::size_t kMany = 4096;
  const std::size_t step = values.size() / kMany + 1;
  std::vector<double> some;
  some.reserve(values.size() / step + 1);
  for (std::size_t i = 0; i < values.size(); i += step) some.push_back(values[i]);
  return some;
}

// Whether `a` is a better end than `b`.
bool better(const Ending& a, const Ending& b) {
  if (!std::isfinite(b.scale)) return std::isfinite(a.scale);
  if (a.sound != b.sound) return a.sound;
  if (a.converged != b.converged) return a.converged;
  if (a.converged && a.masks == b.masks) {
    const auto views = [](const Ending& e) {
      return std::count(e.used.begin(), e.used.end(), true);
    };
    if (views(a) != views(b)) return views(a) > views(b);
    return a.problem->cost() < b.problem->cost();
  }
  return trimmed_rms(a.distances) < trimmed_rms(b.distances);
}

class Course {
 public:
  Course(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
         const Freedom& freedom, const SolveOptions& options, const std::stop_token& stop)
      : shape_(shape),
        freedom_(freedom),
        options_(options),
        least_squares_(freedom, size, stop),
        search_(least_squares_, freedom, shape, size) {
    views_.reserve(views.size());
    for (PointSet& view : views) views_.emplace_back(std::move(view), shape, last_of(views_));
    for (const FitView& view : views_) all_.push_back(&view);
  }

  Fit run() {
    Candidate quick = search_.quick(all_);
    lambda_ = kNearLambda;
    if (std::isfinite(quick.scale)) follow(std::move(quick));
    lambda_ = kFarLambda;
    if (!good(end_) && !least_squares_.cancelled()) explore();
    if (!least_squares_.cancelled()) return finish();
    Fit fit;
    fit.cancelled = true;
    return fit;
  }

 private:
  [[nodiscard]] bool good(const Ending& end) const { return end.sound && !search_.far(end.scale); }

  // Follows every start that may be right and keeps the best end.
  void explore() {
    Ending best = std::move(end_);
    std::vector<Candidate> starts = search_.thorough(all_);
    // With many views the likeliest start is nearly always right.
    constexpr std::size_t kPlenty = 2;
    if (!search_.many_valleys(all_) && !search_.rich() && starts.size() > kPlenty) {
      starts.resize(kPlenty);
    }
    for (Candidate& start : starts) {
      if (least_squares_.cancelled()) break;
      follow(std::move(start));
      remember();
      if (better(end_, best)) std::swap(end_, best);
      if (good(best) && !search_.many_valleys(all_)) break;
    }
    end_ = std::move(best);
    if (end_.converged && all_.size() < kFewViews) mirror_views();
  }

  // Tries the mirrored tilt of each view: a board that is small or hardly tilted fits nearly as
  // well in it, and few views do not tell which pose is wrong.
  void mirror_views() {
    for (std::size_t v = 0; v < views_.size() && !least_squares_.cancelled(); ++v) {
      if (!end_.used[v] || !mirrored_fits(v)) continue;
      Ending before = std::exchange(end_, {});
      end_.shared = before.shared;
      end_.poses = before.poses;
      end_.poses[v] = mirrored_tilt(*end_.poses[v], center_of(views_[v].set));
      solve_masked(before.masks);
      measure();
      remember();
      if (!better(end_, before)) end_ = std::move(before);
    }
  }

  // Whether a view fits not much worse in the mirrored tilt, before the same camera.
  bool mirrored_fits(std::size_t v) {
    constexpr double kMuchWorse = 10;  // ratio of the costs
    const auto camera = least_squares_.camera(end_.shared);
    const auto fit = camera ? fit_pose(end_.views[v]->set, *camera, Loss{}) : std::nullopt;
    return fit && fit->other_cost < kMuchWorse * fit->cost;
  }

  // Keeps a sound end as a possible rival of the best; two ends of one cost are the same.
  void remember() {
    if (!end_.sound) return;
    const double cost = end_.problem->cost();
    const auto same = [&](const Found& f) { return std::abs(f.rival.cost - cost) <= kSame * cost; };
    if (std::any_of(found_.begin(), found_.end(), same)) return;
    found_.push_back({{end_.shared, cost}, end_.masks, end_.used});
  }

  // Solves from a start, without the outliers that show on the way.
  void follow(Candidate start) {
    end_ = Ending();
    end_.shared = std::move(start.shared);
    end_.poses = std::move(start.poses);
    plain_fit(options_.reject_outliers ? robust_fit() : everything());
    if (!least_squares_.cancelled()) measure();
  }

  void measure() {
    end_.distances = distances();
    end_.scale = robust_scale(some_of(end_.distances));
    end_.sound = end_.converged && sound();
  }

  bool sound() {
    const auto reduced = end_.problem->reduced();
    if (!reduced) return false;
    end_.information = reduced->information;
    const Eigen::Index n = end_.information.rows();
    if (!scaled_solve(end_.information, Eigen::MatrixXd::Identity(n, n), kLeastPivot)) return false;
    return !search_.rich() || sees_corners();
  }

  // Whether every corner in use has a projection: a rational lens may have a pole between two
  // corners.
  [[nodiscard]] bool sees_corners() const {
    const auto camera = least_squares_.camera(end_.shared);
    if (!camera) return false;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (!end_.used[v]) continue;
      const PointSet& view = end_.views[v]->set;
      for (std::size_t i = 0; i < view.size(); ++i) {
        if (view.weight[i] > 0 && !camera->project(*end_.poses[v] * view.points[i])) return false;
      }
    }
    return true;
  }

  [[nodiscard]] std::vector<ViewMask> everything() const {
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
    std::vector<ViewMask> masks = judge();
    if (!any_outlier(masks)) return masks;
    robust_step(Loss::Kind::kHuber, 1e-8);
    robust_step(Loss::Kind::kCauchy, 1e-8);
    return judge();
  }

  // The distances of all corners from where the end so far puts them, px.
  std::vector<double> distances() {
    std::vector<double> all;
    all.reserve(views_.empty() ? 0 : views_.size() * views_.front().set.size());
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const auto d = least_squares_.distances(views_[v], end_.shared, end_.poses[v]);
      all.insert(all.end(), d.begin(), d.end());
    }
    return all;
  }

  void robust_step(Loss::Kind kind, double tolerance) {
    const Loss loss{kind, 2.5 * robust_scale(distances())};
    (void)least_squares_.minimise_over(all_, end_.shared, end_.poses, freedom_.basis, loss,
                                       {options_.max_iterations, tolerance, 0, lambda_});
  }

  // The outliers at the end so far. A view that looks wrong gets a second chance from a fresh pose,
  // because its own may have been drawn into the mirrored tilt; so does a view without a pose.
  std::vector<ViewMask> judge() {
    std::vector<std::vector<double>> distances;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      distances.push_back(least_squares_.distances(views_[v], end_.shared, end_.poses[v]));
    }
    std::vector<ViewMask> masks = find_outliers(distances);
    const auto camera = least_squares_.camera(end_.shared);
    moved_ = false;
    for (std::size_t v = 0; camera && v < views_.size() && !least_squares_.cancelled(); ++v) {
      if (end_.poses[v] && (masks[v].view || !options_.reject_outliers)) continue;
      const auto fit = fit_pose(views_[v].set, *camera, {Loss::Kind::kHuber, 1});
      if (!fit) continue;
      auto fresh = least_squares_.distances(views_[v], end_.shared, fit->camera_from_board);
      if (!(robust_scale(fresh) < 0.99 * robust_scale(distances[v]))) continue;
      end_.poses[v] = fit->camera_from_board;
      distances[v] = std::move(fresh);
      moved_ = true;
    }
    return moved_ ? find_outliers(distances) : masks;
  }

  // The final least squares without the outliers, which are judged anew by its result.
  void plain_fit(std::vector<ViewMask> masks) {
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds && !least_squares_.cancelled(); ++round) {
      solve_masked(masks);
      if (!end_.problem || round + 1 == kRounds) return;
      const bool all_posed = std::all_of(end_.poses.begin(), end_.poses.end(),
                                         [](const auto& pose) { return pose.has_value(); });
      if (!options_.reject_outliers && all_posed) return;
      std::vector<ViewMask> next = judge();
      if (!options_.reject_outliers) next = masks;
      if (next == masks && !moved_) return;
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
    return end_.masked.emplace_back(std::move(set), shape_, &view);
  }

  void solve_masked(const std::vector<ViewMask>& masks) {
    end_.masks = masks;
    end_.views.clear();
    end_.masked.clear();
    end_.masked.reserve(views_.size());
    std::vector<const FitView*> views;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const FitView& view = masked(views_[v], masks[v]);
      end_.views.push_back(&view);
      views.push_back(masks[v].view && spans_plane(view.set) ? &view : nullptr);
    }
    // The basin of a rich lens is long and bent: one run of the iteration may end half way.
    const int goes = search_.rich() ? 3 : 1;
    for (int go = 0; go < goes; ++go) {
      end_.problem = least_squares_.minimise_over(views, end_.shared, end_.poses, freedom_.basis,
                                                  Loss{}, final_options(views));
      end_.converged = end_.problem && least_squares_.converged();
      if (!end_.problem || end_.converged || least_squares_.cancelled()) break;
    }
    end_.used.assign(views_.size(), false);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      end_.used[v] = end_.problem && views[v] != nullptr && end_.poses[v];
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
    end_.used.resize(views_.size(), false);
    std::size_t corner = 0;  // index among the corners of all views
    for (std::size_t v = 0; v < views_.size(); ++v) {
      fit.camera_from_board.push_back(end_.used[v] ? *end_.poses[v] : SE3{});
      // Corners that were left out have their squares too.
      fit.squares.emplace_back();
      if (end_.used[v]) fit.squares[v] = squares(views_[v].set.weight, &end_.distances[corner]);
      corner += views_[v].set.size();
    }
    fit.shared = std::move(end_.shared);
    fit.used = end_.used;
    fit.views = take_views();
    if (!end_.problem) return fit;
    fit.cost = end_.problem->cost();
    fit.converged = end_.converged && end_.information.size() > 0;
    fit.sound = end_.sound;
    fit.information = std::move(end_.information);
    for (Found& found : found_) {
      const bool better = found.rival.cost <= (1 + kSame) * fit.cost;
      const bool same_corners = found.masks == end_.masks && found.used == end_.used;
      if (same_corners && !better) fit.rivals.push_back(std::move(found.rival));
    }
    return fit;
  }

  // Moves the views out of the end, which needs them no more.
  std::vector<PointSet> take_views() {
    std::vector<PointSet> taken;
    taken.reserve(end_.views.size());
    auto masked = end_.masked.begin();
    for (std::size_t v = 0; v < end_.views.size(); ++v) {
      FitView& view = end_.views[v] == &views_[v] ? views_[v] : *masked++;
      taken.push_back(std::move(view.set));
    }
    return taken;
  }

  const BoardShape& shape_;
  const Freedom& freedom_;
  const SolveOptions& options_;
  LeastSquares least_squares_;
  StartSearch search_;

  std::vector<FitView> views_;
  std::vector<const FitView*> all_;
  struct Found {
    Rival rival;
    std::vector<ViewMask> masks;
    std::vector<bool> used;
  };
  std::vector<Found> found_;
  Ending end_;
  bool moved_ = false;  // whether the last judge() moved a pose
  double lambda_ = kFarLambda;
};

}  // namespace

Fit fit_camera(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
               const Freedom& freedom, const SolveOptions& options, const std::stop_token& stop) {
  return Course(std::move(views), shape, size, freedom, options, stop).run();
}

}  // namespace calvin
