// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/plane_pose.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace calvin {

namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;

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

// Sum of p p^T (x) (I - r r^T): the squared distances of H p from the rays, over vec(H).
Matrix9 normal_matrix(const std::vector<Eigen::Vector3d>& points,
                      const std::vector<Eigen::Vector3d>& rays, const Normalisation& n) {
  Matrix9 m = Matrix9::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (rays[k].isZero()) continue;
    const Eigen::Vector3d p((points[k].x() - n.x) * n.scale, (points[k].y() - n.y) * n.scale, 1);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - rays[k] * rays[k].transpose();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) m.block<3, 3>(3 * i, 3 * j) += p[i] * p[j] * across;
    }
  }
  return m;
}

}  // namespace

std::optional<SE3> pose_from_rays(const std::vector<Eigen::Vector3d>& points,
                                  const std::vector<Eigen::Vector3d>& rays) {
  const Normalisation n = normalisation(points, rays);
  if (n.count < 4 || !std::isfinite(n.scale)) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(normal_matrix(points, rays, n));
  if (eigen.info() != Eigen::Success ||
      !(eigen.eigenvalues()[1] > 1e-12 * eigen.eigenvalues()[8])) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
  Eigen::Matrix3d m;
  m.col(0) = h.segment<3>(0) * n.scale;
  m.col(1) = h.segment<3>(3) * n.scale;
  m.col(2) = h.segment<3>(6) - n.x * m.col(0) - n.y * m.col(1);

  double ahead = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at = m * Eigen::Vector3d(points[i].x(), points[i].y(), 1);
    ahead += rays[i].dot(at) / std::max(at.norm(), 1e-300);
  }
  m *= (ahead < 0 ? -2 : 2) / (m.col(0).norm() + m.col(1).norm());
  Eigen::Matrix3d rotation;
  rotation << m.col(0), m.col(1), m.col(0).cross(m.col(1));
  if (!m.allFinite() || !rotation.allFinite()) return std::nullopt;
  return SE3{closest_rotation(rotation), m.col(2)};
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
