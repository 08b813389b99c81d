// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The projection matrix by an eigenvector of its normal matrix, taken apart into camera and pose.

#include "calvin/solve/start/projection_matrix.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/start/ray_bundle.hpp"

namespace calvin {

namespace {

// The similarity that takes the points with a ray to centroid 0 and mean distance 1.
struct Similarity {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double scale = 0;
  int count = 0;
};

Similarity normalising(const std::vector<Eigen::Vector3d>& points,
                       const std::vector<Eigen::Vector3d>& rays) {
  Similarity s;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (rays[i].isZero()) continue;
    s.centroid += points[i];
    ++s.count;
  }
  s.centroid /= s.count;
  double distance = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!rays[i].isZero()) distance += (points[i] - s.centroid).norm();
  }
  s.scale = s.count / distance;
  return s;
}

// Of the sum of w X X^T (x) (I - r r^T), the squared distances of P X from the rays over vec(P),
// the eigenvector of the smallest eigenvalue; absent where another one is as small.
std::optional<ProjectionMatrix> weighted_matrix(const std::vector<Eigen::Vector3d>& points,
                                                const std::vector<Eigen::Vector3d>& rays,
                                                const std::vector<double>& weights) {
  constexpr double kSecond = 1e-11;  // of the sum: the least second eigenvalue of one matrix
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(12, 12);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& r = rays[i];
    if (r.isZero()) continue;
    const Eigen::Vector4d x(points[i].x(), points[i].y(), points[i].z(), 1);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - r * r.transpose();
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        normal.block<3, 3>(3 * a, 3 * b) += weights[i] * x[a] * x[b] * across;
      }
    }
  }
  const auto eigen = symmetric_eigen(normal);
  if (!eigen || !(eigen->values[1] > kSecond * eigen->values.sum())) return std::nullopt;
  return ProjectionMatrix(eigen->vectors.col(0).reshaped(3, 4));
}

Eigen::Vector3d direction(const ProjectionMatrix& p, const Eigen::Vector3d& point) {
  return (p * point.homogeneous()).normalized();
}

// The sines of the angles between the rays and the lines that the matrix has: which side is ahead
// is told once the matrix is known.
std::vector<double> sines(const std::vector<Eigen::Vector3d>& points,
                          const std::vector<Eigen::Vector3d>& rays, const ProjectionMatrix& p) {
  std::vector<double> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    all.push_back(rays[i].cross(direction(p, points[i])).norm());
  }
  return all;
}

bool is_behind(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& rays,
               const ProjectionMatrix& p) {
  double ahead = 0;
  for (std::size_t i = 0; i < points.size(); ++i) ahead += rays[i].dot(direction(p, points[i]));
  return ahead < 0;
}

}  // namespace

std::optional<ProjectionMatrix> projection_matrix(const std::vector<Eigen::Vector3d>& points,
                                                  const std::vector<Eigen::Vector3d>& camera_rays) {
  constexpr int kRounds = 10;
  const Similarity s = normalising(points, camera_rays);
  if (s.count < 6 || !std::isfinite(s.scale)) return std::nullopt;
  const Eigen::Matrix3d widen = widening(camera_rays);
  std::vector<Eigen::Vector3d> rays;
  std::vector<Eigen::Vector3d> normalised;
  for (std::size_t i = 0; i < points.size(); ++i) {
    rays.push_back((widen * camera_rays[i]).normalized());
    normalised.emplace_back(s.scale * (points[i] - s.centroid));
  }
  std::vector<double> weights(points.size(), 1);
  auto found = weighted_matrix(normalised, rays, weights);
  for (int i = 0; i < kRounds && found; ++i) {
    if (!reweight_far_off(rays, sines(normalised, rays, *found), weights)) break;
    found = weighted_matrix(normalised, rays, weights);
  }
  if (!found) return std::nullopt;
  ProjectionMatrix p = widen.inverse() * *found;
  p.leftCols<3>() *= s.scale;
  p.col(3) -= p.leftCols<3>() * s.centroid;
  if (is_behind(points, camera_rays, p)) p = -p;
  if (!p.allFinite()) return std::nullopt;
  return p;
}

std::optional<DecomposedProjection> decompose(const ProjectionMatrix& p) {
  const Eigen::Matrix3d m = p.leftCols<3>();
  if (!(m.determinant() > 0)) return std::nullopt;
  // From the last row up, each axis of the camera is what is left of a row beside those below it.
  Eigen::Matrix3d r;
  Eigen::Matrix3d k = Eigen::Matrix3d::Zero();
  for (int row = 2; row >= 0; --row) {
    Eigen::Vector3d left = m.row(row);
    for (int below = 2; below > row; --below) {
      k(row, below) = left.dot(r.row(below));
      left -= k(row, below) * r.row(below).transpose();
    }
    k(row, row) = left.norm();
    r.row(row) = left / k(row, row);
  }
  const Eigen::Vector3d t = k.triangularView<Eigen::Upper>().solve(p.col(3));
  DecomposedProjection result = {k / k(2, 2), {r, t}};
  if (!result.k.allFinite() || !r.allFinite() || !t.allFinite()) return std::nullopt;
  return result;
}

std::optional<SE3> pose_in_space(const std::vector<Eigen::Vector3d>& points,
                                 const std::vector<Eigen::Vector3d>& rays) {
  const auto p = projection_matrix(points, rays);
  if (!p) return std::nullopt;
  const Eigen::Matrix3d m = p->leftCols<3>();
  const double scale = std::cbrt(m.determinant());
  if (!(scale > 0)) return std::nullopt;
  const SE3 pose = {closest_rotation(m), p->col(3) / scale};
  if (!pose.rotation.allFinite() || !pose.translation.allFinite()) return std::nullopt;
  return pose;
}

}  // namespace calvin
