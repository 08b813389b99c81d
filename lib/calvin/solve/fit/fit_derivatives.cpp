// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fills the rows of each view and eliminates its pose.

#include "calvin/solve/fit/fit_derivatives.hpp"

#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

namespace {

constexpr Eigen::Index kTranslation = 3;  // the first column of RowLayout that moves the board

ViewDerivatives derivatives(const Fit& fit, std::size_t v, const ViewPoints& points,
                            ViewRows& rows) {
  const auto height = static_cast<Eigen::Index>(points.padded());
  const Eigen::Map<const Eigen::MatrixXd> all(rows.u(0), 2 * height, rows.layout().columns());
  ViewDerivatives by;
  by.view = v;
  by.ids.assign(points.ids().begin(), points.ids().end());
  by.residual = all.col(RowLayout::kResidual);
  by.pose = all.leftCols(RowLayout::kPose);
  by.shared = all.rightCols(rows.layout().shared());
  const Eigen::MatrixXd transposed = by.pose.transpose();
  const auto to_pose = scaled_solve(product(transposed, by.pose), transposed, 0);
  by.to_pose = to_pose ? *to_pose : Eigen::MatrixXd::Zero(RowLayout::kPose, 2 * height);
  by.shared -= product(by.pose, product(by.to_pose, by.shared));
  by.along = by.pose.middleCols<3>(kTranslation).lazyProduct(fit.camera_from_board[v].rotation);
  return by;
}

}  // namespace

void for_view_derivatives(const Fit& fit, const BoardShape& shape,
                          const Parameterization& parameterization,
                          const std::function<void(ViewDerivatives)>& use) {
  const ParameterTable& table = parameterization.table;
  ViewRows rows(row_layout(table, 0, 0));
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    const ViewPoints points(fit.views[v], shape);
    rows.resize(points.padded());
    fill_rows_of(parameterization.model)(points, row_point(table, 0, 0, fit.shared),
                                         fit.camera_from_board[v], Loss{}, rows, RowContent::kAll);
    use(derivatives(fit, v, points, rows));
  }
}

}  // namespace calvin
