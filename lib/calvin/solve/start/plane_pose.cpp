// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The homography of a plane by an eigenvector of its normal matrix, and the pose in it.

#include "calvin/solve/start/plane_pose.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/solve/linear/cholesky.hpp"
#include "calvin/solve/start/ray_bundle.hpp"

namespace calvin {

namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// The similarity of the plane that takes the points with a ray to centroid 0 and mean distance 1.
struct Normalisation {
  double x = 0;
  double y = 0;
  double scale = 0;
  int count = 0;
};

Normalisation normalisation(const std::vector<Eigen::Vector3d>& points,
                            const std::vector<Eigen::Vector3d>& rays) {
  Normalisation n;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (rays[i].isZero()) continue;
    n.x += points[i].x();
    n.y += points[i].y();
    ++n.count;
  }
  n.x /= n.count;
  n.y /= n.count;
  double distance = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].x() - n.x;
    const double y = points[i].y() - n.y;
    if (!rays[i].isZero()) distance += std::sqrt(x * x + y * y);
  }
  n.scale = n.count / distance;
  return n;
}

// Sum of w p p^T (x) (I - r r^T): the squared distances of H p from the rays, over vec(H). Both
// factors are symmetric: six numbers each.
Matrix9 normal_matrix(const std::vector<Eigen::Vector3d>& points,
                      const std::vector<Eigen::Vector3d>& rays, const std::vector<double>& weights,
                      const Normalisation& n) {
  Matrix6 sums = Matrix6::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d& r = rays[k];
    if (r.isZero()) continue;
    const double w = weights[k];
    const double x = (points[k].x() - n.x) * n.scale;
    const double y = (points[k].y() - n.y) * n.scale;
    const Eigen::Vector3d wr = w * r;
    const double across[6] = {w - wr[0] * r[0], -wr[0] * r[1], w - wr[1] * r[1],
                              -wr[0] * r[2],    -wr[1] * r[2], w - wr[2] * r[2]};
    const double products[6] = {x * x, x * y, y * y, x, y, 1};
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) sums(i, j) += products[j] * across[i];
    }
  }
  constexpr int kPair[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
  Matrix9 m;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) m(i, j) = sums(kPair[i % 3][j % 3], kPair[i / 3][j / 3]);
  }
  return m;
}

// The eigenvector of the smallest eigenvalue, by inverse iteration. Absent where another eigenvalue
// is as small, next to the largest: more than one homography fits.
std::optional<Vector9> smallest_eigenvector(Matrix9 m) {
  constexpr double kFloor = 1e-15;   // of the trace: keeps an exact fit from being singular
  constexpr double kSecond = 1e-12;  // of the trace: the least second eigenvalue of one homography
  const double trace = m.trace();
  m.diagonal().array() += kFloor * trace;
  double factor[81];
  if (!cholesky_of<9>(m.data(), 0, factor)) return std::nullopt;
  const auto apply_inverse = [&factor](Vector9 x) {
    solve_lower<9>(factor, x.data());
    solve_upper<9>(factor, x.data());
    return x;
  };
  Vector9 first = Vector9::Ones() / 3;
  for (int i = 0; i < 8; ++i) {
    const Vector9 next = apply_inverse(first).normalized();
    const double change = (next - first).squaredNorm();
    first = next;
    if (change < 1e-16) break;
  }
  Vector9 second = Vector9::LinSpaced(-1, 1);
  double inverse = 0;
  for (int i = 0; i < 2; ++i) {
    second = apply_inverse((second - first * first.dot(second)).normalized());
    second -= first * first.dot(second);
    inverse = second.norm();
  }
  if (!first.allFinite() || !(1 / inverse > kSecond * trace)) return std::nullopt;
  return first;
}

// The direction of a ray that has gone through widening(), of length 1; a zero ray stays zero.
Eigen::Vector3d unit(const Eigen::Vector3d& ray) {
  const double length = ray.norm();
  return length > 0 ? Eigen::Vector3d(ray / length) : ray;
}

std::optional<Eigen::Matrix3d> weighted_homography(const std::vector<Eigen::Vector3d>& points,
                                                   const std::vector<Eigen::Vector3d>& rays,
                                                   const std::vector<double>& weights,
                                                   const Normalisation& n) {
  const auto eigenvector = smallest_eigenvector(normal_matrix(points, rays, weights, n));
  if (!eigenvector) return std::nullopt;
  const Vector9& h = *eigenvector;
  Eigen::Matrix3d m;
  m.col(0) = h.segment<3>(0) * n.scale;
  m.col(1) = h.segment<3>(3) * n.scale;
  m.col(2) = h.segment<3>(6) - n.x * m.col(0) - n.y * m.col(1);
  double ahead = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at = m * Eigen::Vector3d(points[i].x(), points[i].y(), 1);
    ahead += weights[i] * rays[i].dot(at) / at.norm();
  }
  if (ahead < 0) m = -m;
  if (!m.allFinite()) return std::nullopt;
  return m;
}

// The chords of the angles between the rays and those of the homography, which grow with the
// angles.
std::vector<double> chords(const std::vector<Eigen::Vector3d>& points,
                           const std::vector<Eigen::Vector3d>& rays, const Eigen::Matrix3d& h) {
  std::vector<double> all;
  all.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at = h * Eigen::Vector3d(points[i].x(), points[i].y(), 1);
    all.push_back((rays[i] - at / at.norm()).norm());
  }
  return all;
}

}  // namespace

std::optional<Eigen::Matrix3d> plane_homography(const std::vector<Eigen::Vector3d>& points,
                                                const std::vector<Eigen::Vector3d>& camera_rays) {
  constexpr int kRounds = 10;
  const Normalisation n = normalisation(points, camera_rays);
  if (n.count < 4 || !std::isfinite(n.scale)) return std::nullopt;
  const Eigen::Matrix3d widen = widening(camera_rays);
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(camera_rays.size());
  for (const Eigen::Vector3d& ray : camera_rays) rays.push_back(unit(widen * ray));
  std::vector<double> weights(points.size(), 1);
  auto h = weighted_homography(points, rays, weights, n);
  for (int i = 0; i < kRounds && h; ++i) {
    if (!reweight_far_off(rays, chords(points, rays, *h), weights)) break;
    h = weighted_homography(points, rays, weights, n);
  }
  if (!h) return std::nullopt;
  return widen.inverse() * *h;
}

std::optional<SE3> pose_from_homography(const Eigen::Matrix3d& h) {
  const double scale = 2 / (h.col(0).norm() + h.col(1).norm());
  const Eigen::Vector3d x = h.col(0).normalized();
  const Eigen::Vector3d y = h.col(1).normalized();
  // The bisectors of two directions are at right angles whatever the angle between these.
  const Eigen::Vector3d sum = (x + y).normalized();
  const Eigen::Vector3d difference = (x - y).normalized();
  Eigen::Matrix3d rotation;
  rotation.col(0) = (sum + difference) * std::numbers::sqrt2 / 2;
  rotation.col(1) = (sum - difference) * std::numbers::sqrt2 / 2;
  rotation.col(2) = rotation.col(0).cross(rotation.col(1));
  const SE3 pose = {rotation, h.col(2) * scale};
  // Two directions that are one have no bisectors.
  if (!pose.rotation.allFinite() || !pose.translation.allFinite() ||
      !(rotation.determinant() > 0.5)) {
    return std::nullopt;
  }
  return pose;
}

std::optional<SE3> pose_from_rays(const std::vector<Eigen::Vector3d>& points,
                                  const std::vector<Eigen::Vector3d>& rays) {
  const auto h = plane_homography(points, rays);
  return h ? pose_from_homography(*h) : std::nullopt;
}

SE3 mirrored_tilt(const SE3& camera_from_board, const Eigen::Vector3d& center,
                  const Eigen::Vector3d& board_normal) {
  const Eigen::Vector3d at = camera_from_board * center;
  const Eigen::Vector3d normal = camera_from_board.rotation * board_normal;
  const Eigen::Vector3d axis = normal.cross(at);
  const double tilt = std::atan2(axis.norm(), normal.dot(at));
  // Seen square on, the two poses are one.
  if (!(axis.norm() > 1e-9 * at.norm())) return camera_from_board;
  const Eigen::Matrix3d rotation =
      exp_so3(axis.normalized() * (2 * tilt)) * camera_from_board.rotation;
  return {rotation, at - rotation * center};
}

}  // namespace calvin
