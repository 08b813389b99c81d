// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What each of many views says by itself, one after the other. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"
#include "calvin/solve/linear/arrowhead.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "calvin/solve/residuals/row_plan.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin {

// As a BundleProblem of one camera, one board and one view, whose memory the next view takes over.
class SingleViews {
 public:
  // What is handed over must outlive this.
  SingleViews(const ParameterTable& table, const Eigen::MatrixXd& basis,
              const std::vector<double>& shared);

  // Takes the next view, with the corners that have a weight. False where one has no projection.
  [[nodiscard]] bool next(const PointSet& view, const BoardShape& shape,
                          const SE3& camera_from_board);
  // Of that view.
  [[nodiscard]] std::optional<BundleProblem::Reduced> reduced();
  [[nodiscard]] ViewRows& rows() { return plan_.rows(); }

 private:
  const Eigen::MatrixXd& basis_;
  RowPlan plan_;
  std::optional<ViewPoints> points_;
  ArrowEquations equations_;
  ArrowElimination elimination_;
};

}  // namespace calvin
