// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/fit.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "calvin/solve/least_squares.hpp"
#include "calvin/solve/outliers.hpp"
#include "calvin/solve/pose_fit.hpp"
#include "calvin/solve/start_search.hpp"

namespace calvin {

namespace {

// Of the predicted decrease, relative to the cost: beyond this is rounding.
constexpr double kTolerance = 1e-13;

class Course {
 public:
  Course(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
         const Freedom& freedom, const SolveOptions& options, const std::stop_token& stop)
      : shape_(shape),
        freedom_(freedom),
        options_(options),
        least_squares_(freedom, size, stop),
        search_(least_squares_, freedom, size) {
    for (PointSet& view : views) views_.emplace_back(std::move(view), shape);
    for (const FitView& view : views_) all_.push_back(&view);
  }

  Fit run() {
    if (!follow(search_.quick(all_)) && !least_squares_.cancelled()) {
      follow(search_.thorough(all_));
    }
    return finish();
  }

 private:
  // False where the start does not lead into a valley that can be the right one.
  bool follow(Candidate start) {
    if (!std::isfinite(start.scale)) return false;
    shared_ = std::move(start.shared);
    poses_ = std::move(start.poses);
    plain_fit(options_.reject_outliers ? robust_fit() : everything());
    return final_converged_ && !search_.far(scale());
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

  // Huber's loss keeps its pull bounded whatever the start; Cauchy's then lets go of the gross.
  std::vector<ViewMask> robust_fit() {
    robust_step(Loss::Kind::kHuber, 1e-5);
    std::vector<ViewMask> masks = judge();
    if (!any_outlier(masks)) return masks;
    robust_step(Loss::Kind::kHuber, 1e-8);
    robust_step(Loss::Kind::kCauchy, 1e-8);
    return judge();
  }

  double scale() {
    std::vector<double> all;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const auto d = least_squares_.distances(views_[v], shared_, poses_[v]);
      all.insert(all.end(), d.begin(), d.end());
    }
    return robust_scale(std::move(all));
  }

  void robust_step(Loss::Kind kind, double tolerance) {
    const Loss loss{kind, 2.5 * scale()};
    (void)least_squares_.minimise_over(all_, shared_, poses_, freedom_.basis, loss,
                                       {options_.max_iterations, tolerance});
  }

  // A view that looks wrong gets a second chance from a fresh pose: its own may have been drawn
  // into the mirrored tilt.
  std::vector<ViewMask> judge() {
    std::vector<std::vector<double>> distances;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      distances.push_back(least_squares_.distances(views_[v], shared_, poses_[v]));
    }
    std::vector<ViewMask> masks = find_outliers(distances);
    const auto camera = least_squares_.camera(shared_);
    bool changed = false;
    for (std::size_t v = 0; camera && v < views_.size() && !least_squares_.cancelled(); ++v) {
      if (masks[v].view && poses_[v]) continue;
      const auto fit = fit_pose(views_[v].set, *camera, {Loss::Kind::kHuber, 1});
      if (!fit) continue;
      auto fresh = least_squares_.distances(views_[v], shared_, fit->camera_from_board);
      if (!(robust_scale(fresh) < 0.99 * robust_scale(distances[v]))) continue;
      poses_[v] = fit->camera_from_board;
      distances[v] = std::move(fresh);
      changed = true;
    }
    return changed ? find_outliers(distances) : masks;
  }

  // The final least squares; who is left out is looked at again with its result.
  void plain_fit(std::vector<ViewMask> masks) {
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds && !least_squares_.cancelled(); ++round) {
      solve_masked(masks);
      if (!options_.reject_outliers || !final_) return;
      std::vector<ViewMask> next = judge();
      if (next == masks) return;
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
    return masked_.emplace_back(std::move(set), shape_);
  }

  void solve_masked(const std::vector<ViewMask>& masks) {
    final_views_.clear();
    std::vector<const FitView*> views;
    masked_.clear();
    masked_.reserve(views_.size());
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const FitView& view = masked(views_[v], masks[v]);
      final_views_.push_back(&view);
      views.push_back(masks[v].view && spans_plane(view.set) ? &view : nullptr);
    }
    final_ = least_squares_.minimise_over(views, shared_, poses_, freedom_.basis, Loss{},
                                          {options_.max_iterations, kTolerance});
    used_.assign(views_.size(), false);
    final_poses_.assign(views_.size(), SE3{});
    for (std::size_t v = 0; v < views_.size(); ++v) {
      used_[v] = final_ && views[v] != nullptr && poses_[v];
      if (used_[v]) final_poses_[v] = *poses_[v];
    }
    final_shared_ = shared_;
    final_converged_ = final_ && least_squares_.converged();
  }

  Fit finish() {
    Fit fit;
    for (const FitView* view : final_views_) fit.views.push_back(view->set);
    fit.squares = squares();
    fit.shared = std::move(final_shared_);
    fit.used = std::move(used_);
    fit.camera_from_board = std::move(final_poses_);
    fit.iterations = least_squares_.iterations();
    fit.cancelled = least_squares_.cancelled();
    if (final_) {
      fit.cost = final_->cost();
      const auto reduced = final_->reduced();
      fit.converged = final_converged_ && reduced.has_value();
      if (reduced) fit.information = reduced->information;
    }
    return fit;
  }

  // Of the corners that were left out too.
  std::vector<std::vector<double>> squares() {
    std::vector<std::vector<double>> result(used_.size());
    for (std::size_t v = 0; v < result.size(); ++v) {
      if (used_[v]) result[v] = least_squares_.squares(views_[v], final_shared_, final_poses_[v]);
    }
    return result;
  }

  const BoardShape& shape_;
  const Freedom& freedom_;
  const SolveOptions& options_;
  LeastSquares least_squares_;
  StartSearch search_;

  std::vector<FitView> views_;
  std::vector<const FitView*> all_;
  std::vector<double> shared_;
  Poses poses_;

  std::optional<CameraProblem> final_;  // refers to final_views_
  std::vector<const FitView*> final_views_;
  std::vector<FitView> masked_;  // those of them that are not as they came
  std::vector<SE3> final_poses_;
  std::vector<bool> used_;
  std::vector<double> final_shared_;
  bool final_converged_ = false;
};

}  // namespace

Fit fit_camera(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
               const Freedom& freedom, const SolveOptions& options, const std::stop_token& stop) {
  return Course(std::move(views), shape, size, freedom, options, stop).run();
}

}  // namespace calvin
