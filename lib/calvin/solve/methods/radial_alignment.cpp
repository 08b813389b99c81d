// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Two rows of the pose from directions, then focal length and depth.

#include "calvin/solve/methods/radial_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/geometry/symmetric.hpp"

namespace calvin {

namespace {

using Points = std::vector<CenteredPoint>;

// The least-squares solution of rows x = right, with columns brought to one length. Absent where
// the rows do not determine it.
std::optional<Eigen::VectorXd> unique_solution(const Eigen::MatrixXd& rows,
                                               const Eigen::VectorXd& right) {
  constexpr double kLeast = 1e-10;  // of the eigenvalues
  const Eigen::VectorXd scale = rows.colwise().norm().transpose();
  if (!(scale.minCoeff() > 0)) return std::nullopt;
  const Eigen::MatrixXd scaled = rows * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd normal = scaled.transpose() * scaled;
  const auto eigen = symmetric_eigen(normal);
  if (!eigen || !(eigen->values[0] > kLeast)) return std::nullopt;
  const Eigen::VectorXd x = normal.ldlt().solve(scaled.transpose() * right);
  return scale.cwiseInverse().asDiagonal() * x;
}

// The point whose place in the image has the most to say of a sign.
const CenteredPoint& farthest_from_center(const Points& seen) {
  return *std::max_element(seen.begin(), seen.end(),
                           [](const CenteredPoint& a, const CenteredPoint& b) {
                             return a.image.squaredNorm() < b.image.squaredNorm();
                           });
}

// Two rows of [R | t], of which the sign is open: that of `rows` for which the farthest point is on
// the side of the centre on which it is seen.
void choose_sign(const Points& seen, Eigen::Matrix<double, 2, 4>& rows) {
  const CenteredPoint& far = farthest_from_center(seen);
  const Eigen::Vector2d at = rows * far.board.homogeneous();
  if (at.dot(far.image) < 0) rows = -rows;
}

// What the directions alone tell: the first two rows of [R | t], and sx.
struct Alignment {
  Eigen::Matrix<double, 2, 4> rows;
  double sx = 1;
};

// ty^2 from the upper left 2x2 block of the rotation over ty (the paper's step (c2)).
std::optional<double> square_of_ty(const Eigen::Matrix2d& u) {
  const double squares = u.squaredNorm();
  const double d = u.determinant();
  // The smaller root, rationalised: it stays finite where the determinant vanishes, as where a row
  // or a column does.
  const double root = std::sqrt(std::max((squares - 2 * d) * (squares + 2 * d), 0.0));
  const double square = 2 / (squares + root);
  return std::isfinite(square) ? std::optional(square) : std::nullopt;
}

// Points in the plane z = 0: five of the six numbers are in the rows, the third column follows from
// their lengths but for its sign, which the focal length tells later.
std::optional<Alignment> align_plane(const Points& seen) {
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd rows(n, 5);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [w, at] = seen[static_cast<std::size_t>(i)];
    rows.row(i) << at.y() * w.x(), at.y() * w.y(), at.y(), -at.x() * w.x(), -at.x() * w.y();
    right[i] = at.x();
  }
  const auto u = unique_solution(rows, right);
  if (!u) return std::nullopt;
  Eigen::Matrix2d block;
  block << (*u)[0], (*u)[1], (*u)[3], (*u)[4];
  const auto square = square_of_ty(block);
  if (!square) return std::nullopt;
  const double ty = std::sqrt(*square);
  block *= ty;
  Alignment result;
  result.rows << block(0, 0), block(0, 1), 0, (*u)[2] * ty, block(1, 0), block(1, 1), 0, ty;
  choose_sign(seen, result.rows);
  const double r3 = std::sqrt(std::max(1 - block.row(0).squaredNorm(), 0.0));
  const double r6 = std::sqrt(std::max(1 - block.row(1).squaredNorm(), 0.0));
  result.rows(0, 2) = r3;
  result.rows(1, 2) = block.row(0).dot(block.row(1)) > 0 ? -r6 : r6;
  return result;
}

std::optional<Alignment> align_space(const Points& seen) {
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd rows(n, 7);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [w, at] = seen[static_cast<std::size_t>(i)];
    rows.row(i) << at.y() * w.transpose(), at.y(), -at.x() * w.transpose();
    right[i] = at.x();
  }
  const auto u = unique_solution(rows, right);
  if (!u) return std::nullopt;
  const double ty = 1 / u->segment<3>(4).norm();
  Alignment result;
  result.sx = ty * u->segment<3>(0).norm();
  result.rows.row(0) << ty / result.sx * u->segment<3>(0).transpose(), (*u)[3] * ty / result.sx;
  result.rows.row(1) << ty * u->segment<3>(4).transpose(), ty;
  if (!result.rows.allFinite()) return std::nullopt;
  choose_sign(seen, result.rows);
  return result;
}

// The rotation whose first two rows are near these.
Eigen::Matrix3d rotation_of(const Eigen::Matrix<double, 2, 4>& rows) {
  Eigen::Matrix3d r;
  r.row(0) = rows.block<1, 3>(0, 0);
  r.row(1) = rows.block<1, 3>(1, 0);
  r.row(2) = Eigen::Vector3d(r.row(0)).cross(Eigen::Vector3d(r.row(1)));
  return closest_rotation(r);
}

struct FocalAndDepth {
  double focal = 0;
  double tz = 0;
};

// Linear with kappa = 0 (the paper's equation 15), over both coordinates. Absent where a plane is
// seen head-on.
std::optional<FocalAndDepth> focal_and_depth(const Points& seen, const Eigen::Matrix3d& rotation,
                                             double tx, double ty, double sx) {
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd rows(2 * n, 2);
  Eigen::VectorXd right(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [w, at] = seen[static_cast<std::size_t>(i)];
    const Eigen::Vector3d c = rotation * w;
    rows.row(2 * i) << c.x() + tx, -at.x() / sx;
    rows.row(2 * i + 1) << c.y() + ty, -at.y();
    right[2 * i] = c.z() * at.x() / sx;
    right[2 * i + 1] = c.z() * at.y();
  }
  const auto x = unique_solution(rows, right);
  if (!x) return std::nullopt;
  return FocalAndDepth{(*x)[0], (*x)[1]};
}

// The camera of an alignment; absent where focal length and depth cannot be told apart.
std::optional<TsaiCamera> camera_of(const Points& seen, const Alignment& alignment, Pixel center) {
  const Eigen::Matrix3d rotation = rotation_of(alignment.rows);
  const double tx = alignment.rows(0, 3);
  const double ty = alignment.rows(1, 3);
  const auto found = focal_and_depth(seen, rotation, tx, ty, alignment.sx);
  if (!found) return std::nullopt;
  return TsaiCamera{found->focal, 0, alignment.sx, center, {rotation, {tx, ty, found->tz}}};
}

Result<TsaiCamera> aligned(const Points& seen, bool in_space, Pixel center) {
  const std::size_t least = in_space ? 7 : 5;
  if (seen.size() < least) {
    return no_tsai_camera(fmt::format("it has {} points, and needs {} {}", seen.size(), least,
                                      in_space ? "in space" : "in a plane"));
  }
  auto alignment = in_space ? align_space(seen) : align_plane(seen);
  if (!alignment) {
    return no_tsai_camera(
        "the directions of the points from the centre of the image do not determine the pose: give "
        "more points, spread over the image and not on one line");
  }
  auto camera = camera_of(seen, *alignment, center);
  if (camera && !in_space && camera->focal < 0) {
    alignment->rows.col(2) *= -1;
    camera = camera_of(seen, *alignment, center);
  }
  if (!camera) {
    return no_tsai_camera(
        "the plane is seen head-on, where focal length and distance cannot be told apart: tilt it "
        "by 30 degrees or more");
  }
  if (!(camera->focal > 0) || !(camera->camera_from_board.translation.z() > 0)) {
    return no_tsai_camera(
        "the points come out behind the camera: their frame is left-handed (turn one axis round, "
        "as -Z), "
        "the picture is mirrored, or the plane is seen nearly head-on");
  }
  return *camera;
}

}  // namespace

Pixel TsaiCamera::project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d at = camera_from_board * point;
  const Eigen::Vector2d ideal = focal * at.head<2>() / at.z();
  const double length = ideal.norm();
  const double factor = length > 0 ? seen_radius(length, kappa) / length : 1;
  return {center.u + sx * factor * ideal.x(), center.v + factor * ideal.y()};
}

// The radius at which what an ideal radius leads to is seen: the inverse of r (1 + kappa r^2).
double seen_radius(double ideal, double kappa) {
  double r = ideal;
  if (kappa < 0) {
    const double fold = 1 / std::sqrt(-3 * kappa);
    if (ideal >= fold * 2 / 3) return fold;
    r = std::min(r, 0.99 * fold);
  }
  for (int i = 0; i < 50; ++i) {
    const double step = (r * (1 + kappa * r * r) - ideal) / (1 + 3 * kappa * r * r);
    r -= step;
    if (std::abs(step) < 1e-12 * (1 + r)) break;
  }
  return r;
}

std::vector<CenteredPoint> centered_points(const PointSet& view, const SE3& frame_from_board,
                                           Pixel center) {
  Points seen;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    seen.push_back(
        {frame_from_board * view.points[i], {view.uv[i].u - center.u, view.uv[i].v - center.v}});
  }
  return seen;
}

tl::unexpected<Error> no_tsai_camera(std::string_view why) {
  return make_error(ErrorCode::kDegenerate, fmt::format("Tsai's method finds no camera: {}.", why));
}

Result<TsaiCamera> radial_alignment(const PointSet& view, Pixel center) {
  const bool in_space = spans_space(view);
  const auto plane = in_space ? std::nullopt : board_from_plane(view);
  const SE3 frame_from_board = plane ? plane->inverse() : SE3{};
  auto camera = aligned(centered_points(view, frame_from_board, center), in_space, center);
  if (camera) camera->camera_from_board = camera->camera_from_board * frame_from_board;
  return camera;
}

}  // namespace calvin
