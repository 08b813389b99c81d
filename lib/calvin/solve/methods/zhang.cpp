// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The image of the absolute conic from homographies, the poses, and k1 and k2.

#include "calvin/solve/methods/zhang.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/methods/plane_views.hpp"
#include "calvin/solve/parameters/parameter_order.hpp"
#include "calvin/solve/start/plane_pose.hpp"

namespace calvin {

namespace {

tl::unexpected<Error> no_zhang_camera(std::string why) {
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("Zhang's method finds no camera: {}.", why));
}

using Vector6 = Eigen::Matrix<double, 6, 1>;

// The paper's v_ij: h_i^T B h_j as a row for b = (B11 B12 B22 B13 B23 B33).
Vector6 row(const Eigen::Matrix3d& h, int i, int j) {
  Vector6 v;
  v << h(0, i) * h(0, j), h(0, i) * h(1, j) + h(1, i) * h(0, j), h(1, i) * h(1, j),
      h(2, i) * h(0, j) + h(0, i) * h(2, j), h(2, i) * h(1, j) + h(1, i) * h(2, j),
      h(2, i) * h(2, j);
  return v;
}

// K of the plane one image width before the camera; absent where B is no image of the absolute
// conic.
std::optional<Eigen::Matrix3d> camera_of(const std::vector<Eigen::Matrix3d>& homographies,
                                         const MethodInput& known) {
  Eigen::Matrix<double, 6, 6> m = Eigen::Matrix<double, 6, 6>::Zero();
  for (const Eigen::Matrix3d& h : homographies) {
    const double norm = h.col(0).head<2>().squaredNorm() + h.col(1).head<2>().squaredNorm();
    const Vector6 orthogonal = row(h, 0, 1) / norm;
    const Vector6 equal = (row(h, 0, 0) - row(h, 1, 1)) / norm;
    m += orthogonal * orthogonal.transpose() + equal * equal.transpose();
  }
  // What is known before are equations of great weight: B12 = 0 without a skew, as the paper says,
  // B13 = B23 = 0 with the axis through the centre, B11 = B22 for square pixels.
  const double weight = 1e6 * m.trace();
  const auto add = [&m, weight](const Vector6& equation) {
    m += weight * equation * equation.transpose();
  };
  if (!known.skew) add(Vector6::Unit(1));
  if (known.centered) add(Vector6::Unit(3));
  if (known.centered) add(Vector6::Unit(4));
  if (known.square) add(Vector6::Unit(0) - Vector6::Unit(2));
  const auto eigen = symmetric_eigen(m);
  if (!eigen || !(eigen->values[1] > 1e-13 * eigen->values[5])) return std::nullopt;
  Vector6 b = eigen->vectors.col(0);
  if (!known.skew) b[1] = 0;
  if (b[0] < 0) b = -b;
  const double determinant = b[0] * b[2] - b[1] * b[1];
  if (!(b[0] > 0) || !(determinant > 0)) return std::nullopt;
  const double v0 = (b[1] * b[3] - b[0] * b[4]) / determinant;
  const double lambda = b[5] - (b[3] * b[3] + v0 * (b[1] * b[3] - b[0] * b[4])) / b[0];
  if (!(lambda > 0)) return std::nullopt;
  const double alpha = std::sqrt(lambda / b[0]);
  const double beta = std::sqrt(lambda * b[0] / determinant);
  const double gamma = -b[1] * alpha * alpha * beta / lambda;
  const double u0 = gamma * v0 / beta - b[3] * alpha * alpha / lambda;
  Eigen::Matrix3d k;
  k << alpha, gamma, u0, 0, beta, v0, 0, 0, 1;
  return k;
}

// k1 and k2 by the paper's equation 13, over all points in use. K is that of px.
Eigen::Vector2d coefficients(const MethodInput& input, const Eigen::Matrix3d& k,
                             const std::vector<SE3>& poses) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    const PointSet& view = input.views[v];
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (!(view.weight[i] > 0)) continue;
      const Eigen::Vector3d at = poses[v] * view.points[i];
      const Eigen::Vector2d ideal = at.head<2>() / at.z();
      const double square = ideal.squaredNorm();
      const Eigen::Vector2d from_center = k.topLeftCorner<2, 2>() * ideal;
      const Eigen::Vector2d off =
          Eigen::Vector2d(view.uv[i].u - k(0, 2), view.uv[i].v - k(1, 2)) - from_center;
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d by = from_center[axis] * Eigen::Vector2d(square, square * square);
        normal += by * by.transpose();
        right += off[axis] * by;
      }
    }
  }
  const Eigen::Vector2d found = normal.ldlt().solve(right);
  return found.allFinite() ? found : Eigen::Vector2d::Zero();
}

}  // namespace

Result<MethodResult> zhang_method(const MethodInput& input) {
  const auto planes = plane_views(input, "Zhang's method");
  if (!planes) return tl::unexpected<Error>(planes.error());
  const int unknowns = CameraUnknowns().pinhole().count + (input.skew ? 1 : 0) -
                       (input.centered ? 2 : 0) - (input.square ? 1 : 0);
  const auto least = static_cast<std::size_t>((unknowns + 1) / 2);
  if (input.views.size() < least) {
    return no_zhang_camera(fmt::format("it takes {} views of a plane for {} unknowns, {} given",
                                       least, unknowns, input.views.size()));
  }
  const auto unit = camera_of(planes->homographies, input);
  if (!unit) {
    return no_zhang_camera(
        "the views leave it open, or no camera sees a plane so: tilt it differently in every view, "
        "to the left, to the right, up and down");
  }
  std::vector<SE3> poses;
  for (std::size_t v = 0; v < planes->homographies.size(); ++v) {
    const auto pose = pose_from_homography(unit->inverse() * planes->homographies[v]);
    if (!pose) return no_zhang_camera(fmt::format("view {} has no pose", v));
    poses.push_back(*pose * planes->plane_from_board[v]);
  }
  const Eigen::Matrix3d k = in_pixels(*unit, input.size);
  const Eigen::Vector2d radial = coefficients(input, k, poses);
  auto camera = Camera::make("brown4", input.size,
                             {k(0, 0), k(1, 1), k(0, 2), k(1, 2), radial[0], radial[1], 0, 0},
                             input.skew ? k(0, 1) : 0);
  if (!camera) return tl::unexpected<Error>(camera.error());
  return MethodResult{*std::move(camera), std::move(poses), {}, {}};
}

}  // namespace calvin
