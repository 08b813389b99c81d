// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The displacement fields by which a board may differ from the printed one, with their priors.

#include "calvin/solve/residuals/board_shape.hpp"

#include <utility>

#include "calvin/target/measured/board_fields.hpp"

namespace calvin {

namespace {

constexpr double kAspect = 0.01;  // 1 sigma of the aspect 1, wide for any board made with care

class Maker {
 public:
  void add(const Eigen::VectorXd& field, double prior) {
    fields_.push_back(field);
    shape_.prior.push_back(prior);
  }
  void add_warp(const Board& board) {
    shape_.unknowns.has_warp = true;
    const Eigen::MatrixXd fields = curvature_fields(board);
    for (Eigen::Index i = 0; i < fields.cols(); ++i) add(fields.col(i), wide_curvature(board));
  }
  void add_aspect(const Board& board) {
    shape_.unknowns.has_aspect = true;
    add(aspect_field(board), kAspect);
  }

  BoardShape take(std::size_t points) {
    shape_.modes = fields_.size();
    for (std::size_t i = 0; i < points; ++i) {
      for (const Eigen::VectorXd& field : fields_) {
        shape_.displacement.emplace_back(field.segment<3>(3 * static_cast<Eigen::Index>(i)));
      }
    }
    return std::move(shape_);
  }

 private:
  std::vector<Eigen::VectorXd> fields_;
  BoardShape shape_;
};

}  // namespace

BoardShape make_shape(const Board& board, const SolveOptions& options) {
  // Two rows of points have no curvature, and few have no offsets of their own.
  if (!has_shape(board)) return {};
  Maker maker;
  if (options.warp) maker.add_warp(board);
  if (options.aspect) maker.add_aspect(board);
  BoardShape shape = maker.take(static_cast<std::size_t>(board.point_count()));
  shape.grid = board.grid();
  return shape;
}

std::vector<Eigen::Vector3d> bent_points(const Board& board, const BoardWarp& warp) {
  std::vector<Eigen::Vector3d> points = board.points();
  if (warp.kx == 0 && warp.ky == 0) return points;
  const Eigen::VectorXd bent = curvature_fields(board) * Eigen::Vector2d(warp.kx, warp.ky);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] += bent.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  return points;
}

}  // namespace calvin
