// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The normal equations of one view, its pose eliminated.

#include "calvin/solve/residuals/single_views.hpp"

#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

SingleViews::SingleViews(const ParameterTable& table, const Eigen::MatrixXd& basis,
                         const std::vector<double>& shared)
    : basis_(basis),
      plan_(table, 0, 0),
      equations_({table.count(), 1, 0}),
      elimination_(equations_.layout()) {
  plan_.set(shared);
}

bool SingleViews::next(const PointSet& view, const BoardShape& shape,
                       const SE3& camera_from_board) {
  points_ = ViewPoints(view, shape, points_ ? &*points_ : nullptr);
  equations_.clear();
  if (!plan_.fill(*points_, camera_from_board, Loss{}).valid) return false;
  plan_.add_pose(0, nullptr, equations_);
  return true;
}

std::optional<BundleProblem::Reduced> SingleViews::reduced() {
  if (!elimination_.eliminate(equations_, 0)) return std::nullopt;
  return reduced_to(basis_, elimination_);
}

}  // namespace calvin
