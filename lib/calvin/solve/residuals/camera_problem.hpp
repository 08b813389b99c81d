// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One camera, the shape of its board, and a pose per view as a problem for minimise(). Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"
#include "calvin/solve/linear/arrowhead.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/loss.hpp"
#include "calvin/solve/residuals/view_points.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

// exp(d) * pose, d as in RowLayout.
[[nodiscard]] SE3 retract(const SE3& pose, const double* d);

// The shared unknowns, the directions in which they may move, and their priors.
struct SharedUnknowns {
  const ParameterTable* table = nullptr;
  Eigen::MatrixXd basis;  // unknowns x directions: they move in its span only
  std::vector<ParameterTable::Prior> priors;
};

struct CameraPoint {
  std::vector<double> shared;  // in the order of ParameterTable
  std::vector<SE3> camera_from_board;
};

class CameraProblem {
 public:
  // `views` and the poses of `start` correspond; views and table must outlive the problem. Once
  // `stop` is requested, a linearisation over many views ends early, as if points had no
  // projection.
  CameraProblem(std::vector<const ViewPoints*> views, SharedUnknowns unknowns, CameraPoint start,
                const Loss& loss, std::stop_token stop = {});

  // False where a point has no projection at the start: nothing can be minimised.
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] const CameraPoint& point() const { return current_.point; }

  // For minimise().
  [[nodiscard]] double cost() const { return current_.cost; }
  [[nodiscard]] std::optional<double> propose(double lambda);
  [[nodiscard]] std::optional<double> evaluate_trial();
  void accept() { std::swap(current_, trial_); }
  void accept_unseen(double predicted) {
    std::swap(current_.point, trial_.point);
    current_.cost = std::max(0.0, current_.cost - predicted);
  }

  // The normal equations over the directions of the basis, poses eliminated, not damped, for
  // residuals of 1 px. `information` is the inverse of the marginal covariance. Absent where a pose
  // is not determined.
  struct Reduced {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
    double cost = 0;  // px^2
  };
  [[nodiscard]] std::optional<Reduced> reduced();

 private:
  struct State {
    CameraPoint point;
    ArrowEquations equations;
    double cost = 0;
  };

  [[nodiscard]] const RowLayout& layout() const { return rows_.layout(); }
  bool linearise(State& state);
  std::optional<Eigen::VectorXd> shared_step(double lambda);

  std::vector<const ViewPoints*> views_;
  SharedUnknowns unknowns_;
  FillRows fill_;
  Loss loss_;
  std::stop_token stop_;
  ViewRows rows_;
  ArrowElimination elimination_;
  State current_;
  State trial_;
  AlignedArray products_;
  Eigen::VectorXd damping_;
  bool valid_ = false;
};

}  // namespace calvin
