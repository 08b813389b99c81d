// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rig as a BundleProblem, and which views and corners contradict it. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/rig/start/rig_start.hpp"
#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

class RigSolver {
 public:
  // Refers to all but the places.
  RigSolver(const std::vector<BoardView>& views, RigPlaces places,
            const std::vector<Camera>& cameras, const std::stop_token& stop);

  // From places near the optimum to it, without what contradicts the rest. kDegenerate where that
  // leaves a place undetermined; kCancelled where a stop was requested.
  [[nodiscard]] Status run();

  // The optimum, beside that of run(), where corners of placed views are seen elsewhere by `ways`,
  // px; the views and corners that are in use stay the same.
  struct Optimum {
    std::vector<SE3> camera_from_rig;
    Eigen::VectorXd residuals;  // px, weighted, u and v of all corners in use
  };
  [[nodiscard]] std::optional<Optimum> refit(const std::vector<std::vector<Pixel>>& ways);

  [[nodiscard]] const RigPlaces& places() const { return places_; }
  [[nodiscard]] const std::vector<std::vector<double>>& weights() const { return weights_; }
  [[nodiscard]] bool is_used(std::size_t placed) const;

  // px^2, weighted: the squared distances of all corners of each placed view, of those that are
  // left out too, from where they are expected; infinite for those without a projection, 0 for
  // those that never had a weight.
  using Squares = std::vector<std::vector<double>>;
  [[nodiscard]] Squares squares() const;

  // The equations at the optimum that was found last, over the places of all cameras but the first,
  // for residuals of 1 px; and over all unknowns of a table of these cameras.
  [[nodiscard]] std::optional<BundleProblem::Reduced> equations() { return optimum_->reduced(); }
  [[nodiscard]] std::optional<BundleProblem::Reduced> equations_over(const ParameterTable& table);
  // Those of a pose of a board by itself, over the same table; absent where it is not in use.
  [[nodiscard]] std::optional<BundleProblem::PoseEquations> pose_equations(
      std::size_t pose, const ParameterTable& table);
  // px^2 per residual beyond those that were fitted.
  [[nodiscard]] double variance() const;

 private:
  [[nodiscard]] std::size_t used_poses() const;
  [[nodiscard]] BundleProblem problem(const ParameterTable& table, const Loss& loss);
  [[nodiscard]] bool minimise_over(const Loss& loss, const LmOptions& options, bool goes_on);
  [[nodiscard]] double variance_of(const Squares& squares) const;
  [[nodiscard]] std::vector<double> kept(std::size_t placed, const std::vector<double>& squares,
                                         double variance) const;
  [[nodiscard]] bool leave_out();
  [[nodiscard]] Eigen::VectorXd residuals() const;
  [[nodiscard]] PointSet set_of(std::size_t placed) const;

  const std::vector<BoardView>& views_;
  RigPlaces places_;
  const std::vector<Camera>& cameras_;
  const std::stop_token& stop_;
  ParameterTable table_;
  std::vector<std::vector<double>> weights_;               // of placed views; 0: left out
  const std::vector<std::vector<Pixel>>* ways_ = nullptr;  // of refit(), while it lasts
  std::vector<ViewPoints>
      all_;  // of placed views as they were seen, with the labels of their boards
  std::vector<std::optional<ViewPoints>> points_;    // what is in use, where that is another
  std::vector<CameraPoints> lenses_;                 // of the cameras
  std::vector<std::optional<std::size_t>> numbers_;  // of poses in the last problem
  std::optional<BundleProblem> optimum_;             // of the last one that was minimised
};

// kDegenerate: where the cameras stand is open.
[[nodiscard]] tl::unexpected<Error> undetermined_places();

}  // namespace calvin::rig
