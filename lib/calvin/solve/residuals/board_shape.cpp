// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The displacement fields by which a board may differ from the printed one, with their priors.

#include "calvin/solve/residuals/board_shape.hpp"

#include <cmath>
#include <functional>

#include "calvin/geometry/dense.hpp"

namespace calvin {

namespace {

// Priors, 1 sigma, wide for any board that was made with care.
constexpr double kBend = 0.01;    // of the diagonal of the board
constexpr double kAspect = 0.01;  // of the aspect 1
constexpr double kOffset = 0.05;  // of the distance to the next control point

constexpr int kLeastPoints = 9;  // of a board without a grid

using Points = std::vector<Eigen::Vector3d>;
using Field = std::function<Eigen::Vector3d(double x, double y)>;

// The displacements that a field gives all points; its x and y run from -1 to 1 over their extent,
// as in BoardWarp.
Eigen::VectorXd field_over(const Points& points, const BoardArea& extent, const Field& field) {
  Eigen::VectorXd values(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = 2 * (points[i].x() - extent.left) / extent.width() - 1;
    const double y = 2 * (points[i].y() - extent.top) / extent.height() - 1;
    values.segment<3>(3 * static_cast<Eigen::Index>(i)) = field(x, y);
  }
  return values;
}

Eigen::Vector3d bent_along_x(double x, double /*y*/) { return {0, 0, 1 - x * x}; }
Eigen::Vector3d bent_along_y(double /*x*/, double y) { return {0, 0, 1 - y * y}; }

// An orthonormal basis, in columns, of the displacements that are orthogonal to the fields of
// poses, focal lengths and warp.
Eigen::MatrixXd offset_fields(const Points& points, const BoardArea& extent) {
  const Field others[] = {
      [](double, double) { return Eigen::Vector3d(1, 0, 0); },
      [](double x, double) { return Eigen::Vector3d(x, 0, 0); },
      [](double, double y) { return Eigen::Vector3d(y, 0, 0); },
      [](double, double) { return Eigen::Vector3d(0, 1, 0); },
      [](double x, double) { return Eigen::Vector3d(0, x, 0); },
      [](double, double y) { return Eigen::Vector3d(0, y, 0); },
      [](double, double) { return Eigen::Vector3d(0, 0, 1); },
      [](double x, double) { return Eigen::Vector3d(0, 0, x); },
      [](double, double y) { return Eigen::Vector3d(0, 0, y); },
      bent_along_x,
      bent_along_y,
  };
  const auto rows = 3 * static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd known(rows, static_cast<Eigen::Index>(std::size(others)));
  for (Eigen::Index i = 0; i < known.cols(); ++i)
    known.col(i) = field_over(points, extent, others[i]);
  return orthogonal_complement(known);
}

class Maker {
 public:
  explicit Maker(const Board& board) : points_(board.points()), extent_(board.extent()) {}

  void add(const Eigen::VectorXd& field, double prior) {
    fields_.push_back(field);
    shape_.prior.push_back(prior);
  }
  void add(const Field& field, double prior) { add(field_over(points_, extent_, field), prior); }

  void add_warp() {
    shape_.unknowns.has_warp = true;
    const double diagonal = std::hypot(extent_.width(), extent_.height());
    add(Field(bent_along_x), kBend * diagonal);
    add(Field(bent_along_y), kBend * diagonal);
  }
  void add_aspect() {
    shape_.unknowns.has_aspect = true;
    const double height = extent_.height();
    add([height](double, double y) { return Eigen::Vector3d(0, (y + 1) / 2 * height, 0); },
        kAspect);
  }
  void add_offsets(double cell) {
    const Eigen::MatrixXd fields = offset_fields(points_, extent_);
    shape_.unknowns.offset_count = static_cast<int>(fields.cols());
    for (Eigen::Index i = 0; i < fields.cols(); ++i) {
      add(Eigen::VectorXd(fields.col(i)), kOffset * cell);
    }
  }

  BoardShape take() {
    shape_.modes = fields_.size();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      for (const Eigen::VectorXd& field : fields_) {
        shape_.displacement.emplace_back(field.segment<3>(3 * static_cast<Eigen::Index>(i)));
      }
    }
    return std::move(shape_);
  }

 private:
  Points points_;
  BoardArea extent_;
  std::vector<Eigen::VectorXd> fields_;
  BoardShape shape_;
};

}  // namespace

BoardShape make_shape(const Board& board, const SolveOptions& options) {
  // Two rows of points have no curvature, and few have no offsets of their own.
  const auto grid = board.grid();
  if (grid ? grid->cols < 3 || grid->rows < 3 : board.point_count() < kLeastPoints) return {};
  Maker maker(board);
  if (options.warp) maker.add_warp();
  if (options.aspect) maker.add_aspect();
  if (options.offsets) maker.add_offsets(board.cell_size(board.ids().front()));
  return maker.take();
}

std::vector<Eigen::Vector3d> bent_points(const Board& board, const BoardWarp& warp) {
  Points points = board.points();
  if (warp.kx == 0 && warp.ky == 0) return points;
  const BoardArea extent = board.extent();
  const Eigen::VectorXd along_x = field_over(points, extent, bent_along_x);
  const Eigen::VectorXd along_y = field_over(points, extent, bent_along_y);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    points[i] += warp.kx * along_x.segment<3>(at) + warp.ky * along_y.segment<3>(at);
  }
  return points;
}

}  // namespace calvin
