// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The fields by which a board may differ from the printed one, and those that others explain.

#include "calvin/target/measured/board_fields.hpp"

#include <cmath>
#include <vector>

#include "calvin/geometry/dense.hpp"

namespace calvin {

namespace {

constexpr double kBend = 0.01;   // of the diagonal of the board
constexpr int kLeastPoints = 9;  // of a board without a grid

// The displacements that a field gives all points.
template <typename Field>
Eigen::VectorXd field_over(const Board& board, Field field) {
  const std::vector<Eigen::Vector3d> points = board.points();
  const BoardArea extent = board.extent();
  Eigen::VectorXd values(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = 2 * (points[i].x() - extent.left) / extent.width() - 1;
    const double y = 2 * (points[i].y() - extent.top) / extent.height() - 1;
    values.segment<3>(3 * static_cast<Eigen::Index>(i)) = field(x, y);
  }
  return values;
}

}  // namespace

Eigen::MatrixXd curvature_fields(const Board& board) {
  Eigen::MatrixXd fields(3 * board.point_count(), 2);
  fields.col(0) =
      field_over(board, [](double x, double) { return Eigen::Vector3d(0, 0, 1 - x * x); });
  fields.col(1) =
      field_over(board, [](double, double y) { return Eigen::Vector3d(0, 0, 1 - y * y); });
  return fields;
}

Eigen::VectorXd aspect_field(const Board& board) {
  const double height = board.extent().height();
  return field_over(
      board, [height](double, double y) { return Eigen::Vector3d(0, (y + 1) / 2 * height, 0); });
}

Eigen::MatrixXd offset_basis(const Board& board) {
  Eigen::MatrixXd others(3 * board.point_count(), 9);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    others.col(axis) = field_over(board, [&](double, double) { return along; });
    others.col(3 + axis) =
        field_over(board, [&](double x, double) -> Eigen::Vector3d { return x * along; });
    others.col(6 + axis) =
        field_over(board, [&](double, double y) -> Eigen::Vector3d { return y * along; });
  }
  return orthogonal_complement(others);
}

bool has_shape(const Board& board) {
  const auto grid = board.grid();
  return grid ? grid->cols >= 3 && grid->rows >= 3 : board.point_count() >= kLeastPoints;
}

double wide_curvature(const Board& board) {
  const BoardArea extent = board.extent();
  return kBend * std::hypot(extent.width(), extent.height());
}

}  // namespace calvin
