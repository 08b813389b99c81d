// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What ink may do, without what a least squares of smooth displacements tells of it.

#include "inked_board.hpp"

#include "dense_solve.hpp"

namespace calvin::scenes {

Eigen::MatrixX3d random_offsets(double sigma, Random& random) {
  std::normal_distribution<double> ink(0, sigma);
  const auto printed = kBoard.points();
  const auto n = static_cast<Eigen::Index>(printed.size());
  const Eigen::MatrixX3d drawn =
      Eigen::MatrixX3d::NullaryExpr(n, 3, [&](Eigen::Index, Eigen::Index) { return ink(random); });
  Eigen::MatrixXd smooth(n, 5);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d& p = printed[static_cast<std::size_t>(i)];
    smooth.row(i) << 1, p.x(), p.y(), p.x() * p.x(), p.y() * p.y();
  }
  Eigen::MatrixX3d left = drawn;
  const Eigen::MatrixXd linear = smooth.leftCols<3>();
  left.leftCols<2>() = dense::without(linear, drawn.leftCols<2>());
  // A curvature has no more than its own height: its shift and tilt are those of a pose.
  left.col(2) = dense::without(smooth, drawn.col(2));
  return left;
}

}  // namespace calvin::scenes
