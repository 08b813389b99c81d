// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/plane_pose.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace calvin {

namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

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
    if (!rays[i].isZero()) distance += std::hypot(points[i].x() - n.x, points[i].y() - n.y);
  }
  n.scale = n.count / distance;
  return n;
}

// The linear map that takes a narrow bundle of rays to a wide one about z: in a narrow bundle one
// ray for all points fits nearly as well as the truth.
Eigen::Matrix3d spreading(const std::vector<Eigen::Vector3d>& rays) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& ray : rays) mean += ray;
  const Eigen::Matrix3d turn = rotation_between(mean, Eigen::Vector3d::UnitZ());
  double sine = 0;
  double count = 0;
  for (const Eigen::Vector3d& ray : rays) {
    sine += (turn * ray).head<2>().norm();
    count += ray.norm();
  }
  const double scale = std::clamp(count / sine, 1.0, 1e6);
  return Eigen::Vector3d(scale, scale, 1).asDiagonal() * turn;
}

// Sum of w p p^T (x) (I - r r^T): the squared distances of H p from the rays, over vec(H).
Matrix9 normal_matrix(const std::vector<Eigen::Vector3d>& points,
                      const std::vector<Eigen::Vector3d>& rays, const std::vector<double>& weights,
                      const Normalisation& n) {
  Matrix9 m = Matrix9::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (rays[k].isZero()) continue;
    const Eigen::Vector3d p((points[k].x() - n.x) * n.scale, (points[k].y() - n.y) * n.scale, 1);
    const Eigen::Matrix3d across =
        weights[k] * (Eigen::Matrix3d::Identity() - rays[k] * rays[k].transpose());
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) m.block<3, 3>(3 * i, 3 * j) += p[i] * p[j] * across;
    }
  }
  return m;
}

// The eigenvector of the smallest eigenvalue, by inverse iteration. Absent where another eigenvalue
// is as small, next to the largest: more than one homography fits.
std::optional<Vector9> smallest_eigenvector(const Matrix9& lower) {
  constexpr double kFloor = 1e-15;  // of the trace: keeps an exact fit from being singular
  constexpr double kSecond = 1e-12;
  const double trace = lower.trace();
  Matrix9 m = lower;
  m.diagonal().array() += kFloor * trace;
  const Eigen::LLT<Matrix9> factor(m);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Vector9 first = Vector9::Ones().normalized();
  Vector9 second = Vector9::LinSpaced(-1, 1);
  double inverse = 0;
  for (int i = 0; i < 8; ++i) {
    const Vector9 next = factor.solve(first).normalized();
    const double change = (next - first).norm();
    first = next;
    if (change < 1e-12) break;
  }
  for (int i = 0; i < 3; ++i) {
    second = factor.solve((second - first * first.dot(second)).normalized());
    second -= first * first.dot(second);
    inverse = second.norm();
  }
  if (!first.allFinite() || !(1 / inverse > kSecond * trace)) return std::nullopt;
  return first;
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

// Replaces the weights by Cauchy's, with the median angle as its scale; false where no ray is far
// off the others.
bool reweight(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& rays,
              const Eigen::Matrix3d& h, std::vector<double>& weights) {
  constexpr double kFarOff = 4;  // medians; the largest of 1000 Gaussian distances is at 3.2
  std::vector<double> angles;    // their chords, which grow with them
  std::vector<double> sorted;
  angles.reserve(points.size());
  sorted.reserve(points.size());
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at = h * Eigen::Vector3d(points[i].x(), points[i].y(), 1);
    angles.push_back((rays[i] - at / at.norm()).norm());
    if (rays[i].isZero()) continue;
    sorted.push_back(angles.back());
    farthest = std::max(farthest, angles.back());
  }
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = std::max(*middle, 1e-9);
  if (farthest <= kFarOff * median) return false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    weights[i] = 1 / (1 + angles[i] * angles[i] / (median * median));
  }
  return true;
}

}  // namespace

std::optional<Eigen::Matrix3d> plane_homography(const std::vector<Eigen::Vector3d>& points,
                                                const std::vector<Eigen::Vector3d>& camera_rays) {
  constexpr int kRounds = 10;
  const Normalisation n = normalisation(points, camera_rays);
  if (n.count < 4 || !std::isfinite(n.scale)) return std::nullopt;
  const Eigen::Matrix3d spread = spreading(camera_rays);
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(camera_rays.size());
  for (const Eigen::Vector3d& ray : camera_rays) rays.push_back((spread * ray).stableNormalized());
  std::vector<double> weights(points.size(), 1);
  auto h = weighted_homography(points, rays, weights, n);
  for (int i = 0; i < kRounds && h && reweight(points, rays, *h, weights); ++i) {
    h = weighted_homography(points, rays, weights, n);
  }
  if (!h) return std::nullopt;
  return spread.inverse() * *h;
}

std::optional<SE3> pose_from_homography(const Eigen::Matrix3d& h) {
  const Eigen::Matrix3d m = h * (2 / (h.col(0).norm() + h.col(1).norm()));
  Eigen::Matrix3d rotation;
  rotation << m.col(0), m.col(1), m.col(0).cross(m.col(1));
  if (!rotation.allFinite() || !m.allFinite()) return std::nullopt;
  return SE3{closest_rotation(rotation), m.col(2)};
}

std::optional<SE3> pose_from_rays(const std::vector<Eigen::Vector3d>& points,
                                  const std::vector<Eigen::Vector3d>& rays) {
  const auto h = plane_homography(points, rays);
  return h ? pose_from_homography(*h) : std::nullopt;
}

SE3 mirrored_tilt(const SE3& camera_from_board, const Eigen::Vector3d& center) {
  const Eigen::Vector3d at = camera_from_board * center;
  const Eigen::Vector3d normal = camera_from_board.rotation.col(2);
  const Eigen::Vector3d axis = normal.cross(at);
  const double tilt = std::atan2(axis.norm(), normal.dot(at));
  // Seen square on, the two poses are one.
  if (!(axis.norm() > 1e-9 * at.norm())) return camera_from_board;
  const Eigen::Matrix3d rotation =
      exp_so3(axis.normalized() * (2 * tilt)) * camera_from_board.rotation;
  return {rotation, at - rotation * center};
}

}  // namespace calvin
