// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The way of a fit from one start to its optimum, without the outliers that show on the way. Every
// step is a function of what the step before has returned. Internal.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/solve/options.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/residuals/outliers.hpp"
#include "calvin/solve/start/bundle_adjustment.hpp"
#include "calvin/solve/start/start_search.hpp"

namespace calvin {

// The damping where the start is likely near the optimum, and where it may be anywhere.
inline constexpr double kNearLambda = 1e-8;
inline constexpr double kFarLambda = 1e-4;

// How far the fit from one start has come, and in the end its result.
struct FitState {
  Estimate at;                           // poses of all views that have one
  std::optional<BundleProblem> problem;  // over the views in use; refers to `views`
  std::vector<ViewMask> masks;
  std::vector<const FitView*> views;  // without the corners that are masked
  std::vector<FitView> masked;        // the views of which corners are left out
  std::vector<bool> used;
  bool converged = false;
  bool sound = false;           // converged, every unknown is determined, every corner seen
  Eigen::MatrixXd information;  // of the directions of the problem, poses eliminated
  // The larger sigma of a focal length, as a part of it, by the scatter of the residuals.
  double focal_sigma = std::numeric_limits<double>::infinity();
  std::vector<double> distances;  // of all corners from where they belong, px
  double scale = std::numeric_limits<double>::infinity();  // robust_scale() of the distances, px
};

// Whether `a` is a better result than `b`.
[[nodiscard]] bool better(const FitState& a, const FitState& b);

class FitSteps {
 public:
  // Whatever is referred to must outlive the steps and the states that they return.
  FitSteps(const std::vector<FitView>& views, const BoardShape& shape,
           const Parameterization& parameterization, const SolveOptions& options,
           BundleAdjustment& adjustment, const StartSearch& search);

  // The optimum that a start leads to, its outliers left out; once cancelled, some state before.
  [[nodiscard]] FitState solve_from(Estimate start, double lambda);
  // The optimum for these corners alone.
  [[nodiscard]] FitState solve_for(Estimate start, const std::vector<ViewMask>& masks,
                                   double lambda);

 private:
  // Which corners are wrong by an estimate, whose poses may have been replaced by better ones.
  struct Judgement {
    Estimate at;
    std::vector<ViewMask> masks;
    bool pose_moved = false;
    std::vector<std::vector<double>> distances;  // of the corners of each view, px
  };

  [[nodiscard]] std::vector<ViewMask> all_corners() const;
  [[nodiscard]] Judgement robust_fit(Estimate start, double lambda);
  [[nodiscard]] Estimate robust_step(Estimate at, Loss::Kind kind, double tolerance, double lambda);
  [[nodiscard]] Judgement judge(Estimate at);
  [[nodiscard]] FitState fit_inliers(Judgement start, double lambda);
  [[nodiscard]] FitState solve_masked(Estimate at, std::vector<ViewMask> masks, double lambda);
  [[nodiscard]] FitState measured(FitState state);
  [[nodiscard]] bool sees_corners(const FitState& state) const;
  [[nodiscard]] double focal_sigma(const FitState& state, const Eigen::MatrixXd& inverse) const;
  [[nodiscard]] std::vector<std::vector<double>> distances(const Estimate& at);
  [[nodiscard]] double rough_scale(const Estimate& at);
  const FitView& masked(const FitView& view, const ViewMask& mask, FitState& state) const;
  [[nodiscard]] LmOptions final_options(const std::vector<const FitView*>& views,
                                        double lambda) const;

  const std::vector<FitView>& views_;
  std::vector<const FitView*> all_;
  const BoardShape& shape_;
  const Parameterization& parameterization_;
  const SolveOptions& options_;
  BundleAdjustment& adjustment_;
  const StartSearch& search_;
};

}  // namespace calvin
