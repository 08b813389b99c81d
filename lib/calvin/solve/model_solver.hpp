// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The course of one solve for one camera model: start, robust fit, outliers, plain fit. Internal.
#pragma once

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "calvin/solve/arrowhead.hpp"
#include "calvin/solve/fit.hpp"
#include "calvin/solve/freedom.hpp"
#include "calvin/solve/outliers.hpp"
#include "calvin/solve/pose_fit.hpp"
#include "calvin/solve/rays.hpp"
#include "calvin/solve/start.hpp"

namespace calvin {

template <typename M>
class ModelSolver {
 public:
  ModelSolver(std::vector<PointSet> views, ImageSize size, const Freedom& freedom,
              const SolveOptions& options, const std::stop_token& stop)
      : views_(std::move(views)), size_(size), freedom_(freedom), options_(options), stop_(stop) {
    poses_.resize(views_.size());
  }

  // The best fit found. Not converged where the data do not lead anywhere.
  [[nodiscard]] Fit run() {
    std::vector<ViewMask> masks = everything();
    if (start()) {
      if (options_.reject_outliers) masks = robust_fit();
      plain_fit(masks);
    }
    return finish();
  }

 private:
  using Poses = std::vector<std::optional<SE3>>;
  using Parameters = std::array<double, M::kCount>;
  using Basis = typename Arrowhead<M>::Basis;

  struct Candidate {
    Parameters parameters{};
    Poses poses;
    double scale = std::numeric_limits<double>::infinity();  // px, see robust_scale()
  };

  static constexpr std::size_t kTrialViews = 12;
  static constexpr std::size_t kFewViews = 8;
  static constexpr std::size_t kTrials = 4;

  std::vector<ViewMask> everything() const {
    std::vector<ViewMask> masks;
    for (const PointSet& view : views_) masks.push_back({true, std::vector(view.size(), true)});
    return masks;
  }

  // --- Start: guesses are tried on a few views.

  bool start() {
    const std::vector<PointSet> sample = trial_views();
    Candidate known = from_initial(sample);
    // A start that far off is in the wrong valley.
    const double far = 1e-3 * size_.width;
    if (!(known.scale < far)) {
      Candidate found = from_views(sample, far);
      if (found.scale < known.scale) known = std::move(found);
    }
    if (!std::isfinite(known.scale)) return false;
    parameters_ = known.parameters;
    poses_ = poses_for(parameters_, views_);
    return true;
  }

  // From the calibration that the caller has.
  Candidate from_initial(const std::vector<PointSet>& sample) {
    Candidate c;
    if (freedom_.initial.empty()) return c;
    std::copy(freedom_.initial.begin(), freedom_.initial.end(), c.parameters.begin());
    freedom_.hold(c.parameters.data());
    c.poses = poses_for(c.parameters, sample);
    c.scale = scale_of(c, sample);
    improve(c, sample, freedom_.basis, 15);
    return c;
  }

  Candidate from_views(const std::vector<PointSet>& sample, double far) {
    std::vector<Guess> guesses;
    if (M::Lens::kPerspective) guesses = closed_form_guesses(sample, size_);
    const bool sure = !guesses.empty() && sample.size() >= kFewViews;
    const auto grid = focal_grid(size_, M::Lens::kPerspective);
    if (!sure) guesses.insert(guesses.end(), grid.begin(), grid.end());
    Candidate best = best_of(guesses, sample, sure ? 1 : kTrials);
    if (sure && !(best.scale < far)) {
      guesses.insert(guesses.end(), grid.begin(), grid.end());
      Candidate other = best_of(guesses, sample, kTrials);
      if (other.scale < best.scale) best = std::move(other);
    }
    return best;
  }

  std::vector<PointSet> trial_views() const {
    std::vector<PointSet> sample;
    const std::size_t n = std::min(views_.size(), kTrialViews);
    for (std::size_t i = 0; i < n; ++i) sample.push_back(views_[i * views_.size() / n]);
    return sample;
  }

  template <typename Coefficients>
  Parameters start_from(const Guess& guess, const Coefficients& coefficients) const {
    Parameters p;
    std::copy(guess.begin(), guess.end(), p.begin());
    std::copy(coefficients.begin(), coefficients.end(), p.begin() + 4);
    freedom_.hold(p.data());
    return p;
  }

  static Poses poses_for(const Parameters& parameters, const std::vector<PointSet>& views) {
    Poses poses;
    for (const PointSet& view : views) {
      poses.push_back(pose_from_rays(view.points, rays_of<M>(view, parameters.data(), 0)));
    }
    return poses;
  }

  Candidate best_of(const std::vector<Guess>& guesses, const std::vector<PointSet>& sample,
                    std::size_t trials) {
    std::vector<Candidate> candidates;
    for (const Guess& guess : guesses) {
      for (const auto& coefficients : M::Lens::kStarts) {
        Candidate c;
        c.parameters = start_from(guess, coefficients);
        c.poses = poses_for(c.parameters, sample);
        c.scale = scale_of(c, sample);
        candidates.push_back(std::move(c));
      }
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.scale < b.scale; });
    if (candidates.size() > trials) candidates.resize(trials);
    Candidate best;
    Basis focal = Basis::Zero(M::kCount, 1);
    focal(0, 0) = 1;
    focal(1, 0) = freedom_.aspect();
    for (Candidate& c : candidates) {
      if (!freedom_.held[0] && !freedom_.held[1]) improve(c, sample, focal, 5);
      improve(c, sample, freedom_.basis, 15);
      if (c.scale < best.scale) best = std::move(c);
    }
    return best;
  }

  void improve(Candidate& c, const std::vector<PointSet>& sample, const Basis& basis,
               int iterations) {
    std::vector<const PointSet*> views;
    for (const PointSet& view : sample) views.push_back(&view);
    const Loss loss{Loss::Kind::kHuber, 2 * c.scale};
    minimise_over(views, c.parameters, c.poses, basis, loss, {iterations, 1e-4});
    c.scale = scale_of(c, sample);
  }

  static double scale_of(const Candidate& c, const std::vector<PointSet>& views) {
    std::vector<double> all;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto d = distances_of(views[v], c.parameters, c.poses[v]);
      all.insert(all.end(), d.begin(), d.end());
    }
    return robust_scale(std::move(all));
  }

  static std::vector<double> distances_of(const PointSet& view, const Parameters& parameters,
                                          const std::optional<SE3>& pose) {
    if (!pose) return std::vector(view.size(), kFarthest);
    return Reprojection<M>().distances(view, parameters.data(), *pose);
  }

  // --- Least squares over the views that have a pose.

  // `views` and `poses` correspond; a null view is left out. A pose from which its view cannot be
  // projected is forgotten. Returns the problem at its minimum, absent where nothing is left.
  std::optional<Arrowhead<M>> minimise_over(const std::vector<const PointSet*>& views,
                                            Parameters& parameters, Poses& poses,
                                            const Basis& basis, Loss loss,
                                            const LmOptions& options) {
    std::vector<const PointSet*> active;
    std::vector<std::size_t> index;
    CameraAndPoses<M> from;
    from.parameters = parameters;
    Reprojection<M> reprojection;
    ViewEquations<M> equations;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (views[v] == nullptr || !poses[v]) continue;
      if (!reprojection.evaluate(*views[v], parameters.data(), *poses[v], equations)) {
        poses[v].reset();
        continue;
      }
      active.push_back(views[v]);
      index.push_back(v);
      from.camera_from_board.push_back(*poses[v]);
    }
    if (active.empty()) return std::nullopt;
    Arrowhead<M> problem(std::move(active), std::move(from), basis, loss);
    if (!problem.valid()) return std::nullopt;
    const LmReport report = minimise(problem, options, stop_);
    iterations_ += report.iterations;
    converged_ = report.converged;
    cancelled_ = cancelled_ || report.cancelled;
    parameters = problem.point().parameters;
    for (std::size_t i = 0; i < index.size(); ++i) {
      poses[index[i]] = problem.point().camera_from_board[i];
    }
    return problem;
  }

  // --- Outliers.

  // Huber's loss keeps its pull bounded whatever the start; Cauchy's then lets go of the gross.
  std::vector<ViewMask> robust_fit() {
    robust_step(Loss::Kind::kHuber, 1e-5);
    std::vector<ViewMask> masks = judge();
    if (!any_outlier(masks)) return masks;
    robust_step(Loss::Kind::kHuber, 1e-8);
    robust_step(Loss::Kind::kCauchy, 1e-8);
    return judge();
  }

  void robust_step(Loss::Kind kind, double tolerance) {
    std::vector<const PointSet*> views;
    std::vector<double> all;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      views.push_back(&views_[v]);
      const auto d = distances_of(views_[v], parameters_, poses_[v]);
      all.insert(all.end(), d.begin(), d.end());
    }
    const Loss loss{kind, 2.5 * robust_scale(std::move(all))};
    minimise_over(views, parameters_, poses_, freedom_.basis, loss,
                  {options_.max_iterations, tolerance});
  }

  // A view that looks wrong gets a second chance from a fresh pose: its own may have been drawn
  // into the mirrored tilt.
  std::vector<ViewMask> judge() {
    std::vector<std::vector<double>> distances;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      distances.push_back(distances_of(views_[v], parameters_, poses_[v]));
    }
    std::vector<ViewMask> masks = find_outliers(distances);
    bool changed = false;
    for (std::size_t v = 0; v < views_.size() && !stop_.stop_requested(); ++v) {
      if (masks[v].view && poses_[v]) continue;
      const Loss loss{Loss::Kind::kHuber, 1};
      const auto fit = fit_pose<M>(views_[v], parameters_.data(), 0, loss);
      if (!fit) continue;
      auto fresh = distances_of(views_[v], parameters_, fit->camera_from_board);
      if (!(robust_scale(fresh) < 0.99 * robust_scale(distances[v]))) continue;
      poses_[v] = fit->camera_from_board;
      distances[v] = std::move(fresh);
      changed = true;
    }
    return changed ? find_outliers(distances) : masks;
  }

  // --- The final least squares; who is left out is looked at again with its result.

  void plain_fit(std::vector<ViewMask> masks) {
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds && !cancelled_; ++round) {
      solve_masked(masks);
      if (!options_.reject_outliers || !final_) return;
      std::vector<ViewMask> next = judge();
      if (next == masks) return;
      masks = std::move(next);
    }
  }

  void solve_masked(const std::vector<ViewMask>& masks) {
    final_views_ = views_;
    std::vector<const PointSet*> views(views_.size(), nullptr);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      PointSet& view = final_views_[v];
      for (std::size_t i = 0; i < view.size(); ++i) {
        if (!masks[v].corners[i]) view.weight[i] = 0;
      }
      if (masks[v].view && spans_plane(view)) views[v] = &view;
    }
    final_ = minimise_over(views, parameters_, poses_, freedom_.basis, Loss{},
                           {options_.max_iterations, 1e-13});
    used_.assign(views_.size(), false);
    final_poses_.assign(views_.size(), SE3{});
    for (std::size_t v = 0; v < views_.size(); ++v) {
      used_[v] = final_ && views[v] != nullptr && poses_[v];
      if (used_[v]) final_poses_[v] = *poses_[v];
    }
    final_parameters_ = parameters_;
    final_converged_ = final_ && converged_;
  }

  Fit finish() {
    Fit fit;
    fit.parameters.assign(final_parameters_.begin(), final_parameters_.end());
    fit.camera_from_board = std::move(final_poses_);
    fit.views = std::move(final_views_);
    fit.used = std::move(used_);
    fit.iterations = iterations_;
    fit.cancelled = cancelled_ || stop_.stop_requested();
    if (final_) {
      fit.cost = final_->cost();
      const auto information = final_->information();
      fit.converged = final_converged_ && information.has_value();
      if (information) fit.information = *information;
    }
    return fit;
  }

  const std::vector<PointSet> views_;
  const ImageSize size_;
  const Freedom& freedom_;
  const SolveOptions& options_;
  const std::stop_token& stop_;

  Parameters parameters_{};
  Poses poses_;
  int iterations_ = 0;
  bool converged_ = false;
  bool cancelled_ = false;

  std::optional<Arrowhead<M>> final_;  // refers to final_views_
  std::vector<PointSet> final_views_;
  std::vector<SE3> final_poses_;
  std::vector<bool> used_;
  Parameters final_parameters_{};
  bool final_converged_ = false;
};

template <typename M>
Fit fit_model(std::vector<PointSet> views, ImageSize size, const Freedom& freedom,
              const SolveOptions& options, const std::stop_token& stop) {
  return ModelSolver<M>(std::move(views), size, freedom, options, stop).run();
}

}  // namespace calvin
