// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bundle adjustment as every stage of a solve has it: camera and poses of some views are fitted,
// and the distances of corners measured. Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// A view as points and as arrays; the arrays of the printed board may be shared with another view.
struct FitView {
  PointSet set;
  ViewPoints points;

  FitView(PointSet from, const BoardShape& shape, const FitView* other = nullptr)
      : set(std::move(from)), points(set, shape, other == nullptr ? nullptr : &other->points) {}
};

[[nodiscard]] inline const FitView* last_of(const std::vector<FitView>& views) {
  return views.empty() ? nullptr : &views.back();
}

using Poses = std::vector<std::optional<SE3>>;

// Where a fit stands: the shared unknowns, and the poses of those views that have one.
struct Estimate {
  std::vector<double> shared;
  Poses poses;
};

// What one minimisation led to.
struct Minimum {
  Estimate at;
  std::optional<BundleProblem> problem;  // at the minimum; absent where nothing was left to fit
  bool converged = false;
};

class BundleAdjustment {
 public:
  BundleAdjustment(const Parameterization& parameterization, ImageSize size,
                   const std::stop_token& stop);

  // Improves an estimate by the views that have a pose, `more` priors added to those of the
  // parameterization. A null view is left out; a view that has no projection at its pose loses the
  // pose.
  [[nodiscard]] Minimum minimise_over(const std::vector<const FitView*>& views, Estimate from,
                                      const Eigen::MatrixXd& basis, const Loss& loss,
                                      const LmOptions& options,
                                      const std::vector<ParameterTable::Prior>& more = {});

  // Weighted distance of every corner from its projection, px, at most kFarthest; kFarthest for all
  // corners of a view without a pose.
  [[nodiscard]] std::vector<double> distances(const FitView& view,
                                              const std::vector<double>& shared,
                                              const std::optional<SE3>& pose);

  // Absent for parameters of no camera. Once cancelled, poses_for() leaves out the views that
  // remain.
  [[nodiscard]] std::optional<Camera> camera(const std::vector<double>& shared) const;
  [[nodiscard]] Poses poses_for(const std::vector<double>& shared,
                                const std::vector<const FitView*>& views) const;

  // Of all minimisations together.
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] bool cancelled() const { return cancelled_ || stop_.stop_requested(); }

 private:
  RowSums fill_residuals(const FitView& view, const std::vector<double>& shared, const SE3& pose);

  const Parameterization& parameterization_;
  ImageSize size_;
  const std::stop_token& stop_;
  FillRows fill_;
  ViewRows rows_;
  int iterations_ = 0;
  bool cancelled_ = false;
};

// Stands for the distance of a corner that has no projection, px.
inline constexpr double kFarthest = 1e6;

}  // namespace calvin
