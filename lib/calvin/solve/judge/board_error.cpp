// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The derivatives of the optimum by the places of corners on their boards.

#include "calvin/solve/judge/board_error.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

namespace {

// Along x and y of the board. Offsets out of its plane are the curvatures', which are unknowns.
constexpr Eigen::Index kAxes = 2;
constexpr Eigen::Index kTranslation = 3;  // the first column of RowLayout that moves the board

// Where the corners of each board stand among the columns.
std::map<std::size_t, Eigen::Index> first_columns(const Fit& fit, Eigen::Index& count) {
  std::map<std::size_t, Eigen::Index> ids;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    Eigen::Index& most = ids[fit.views[v].board];
    for (const int id : fit.views[v].ids) most = std::max<Eigen::Index>(most, id + 1);
  }
  count = 0;
  for (auto& [board, corners] : ids) count += kAxes * std::exchange(corners, count);
  return ids;
}

// Adds J^T A of one view: J are the derivatives of its residuals by the shared unknowns, the pose
// eliminated, and A those by the places of corners along the axes of the board.
void add_view(const Fit& fit, std::size_t v, const ViewPoints& points, ViewRows& rows,
              Eigen::Index first, Eigen::MatrixXd& sum) {
  const auto height = static_cast<Eigen::Index>(points.padded());
  const Eigen::Map<const Eigen::MatrixXd> all(rows.data(), 2 * height, rows.layout().columns());
  const Eigen::MatrixXd pose = all.leftCols(RowLayout::kPose);
  Eigen::MatrixXd shared = all.rightCols(rows.layout().shared());
  const auto absorbed =
      scaled_solve(product(pose.transpose(), pose), product(pose.transpose(), shared), 0);
  if (!absorbed) return;
  shared -= product(pose, *absorbed);
  const Eigen::Matrix3d& turn = fit.camera_from_board[v].rotation;
  const Eigen::MatrixXd along =
      pose.middleCols<3>(kTranslation).lazyProduct(turn.leftCols<kAxes>());
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(points.count()); ++i) {
    const Eigen::Index at = first + kAxes * points.ids()[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < kAxes; ++k) {
      sum.col(at + k) += along(i, k) * shared.row(i).transpose() +
                         along(height + i, k) * shared.row(height + i).transpose();
    }
  }
}

}  // namespace

Eigen::MatrixXd board_covariance(const Fit& fit, const BoardShape& shape,
                                 const Parameterization& parameterization) {
  Eigen::Index columns = 0;
  const auto first = first_columns(fit, columns);
  const ParameterTable& table = parameterization.table;
  ViewRows rows(row_layout(table, 0, 0));
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows.layout().shared(), columns);
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    const ViewPoints points(fit.views[v], shape);
    rows.resize(points.padded());
    fill_rows_of(parameterization.model)(points, row_point(table, 0, 0, fit.shared),
                                         fit.camera_from_board[v], Loss{}, rows);
    add_view(fit, v, points, rows, first.at(fit.views[v].board), sum);
  }
  const auto moves =
      scaled_solve(fit.information, product(parameterization.basis.transpose(), sum), kLeastPivot);
  const Eigen::Index n = fit.information.rows();
  return moves ? product(*moves, moves->transpose()) : Eigen::MatrixXd::Zero(n, n);
}

}  // namespace calvin
