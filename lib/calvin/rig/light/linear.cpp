// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Direct linear transforms, with random samples and votes.

#include "calvin/rig/light/linear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace calvin::rig {

namespace {

constexpr double kNothing = 1e-12;

double distance(const Matrix34& projection, const Eigen::Vector4d& point, const TrackPoint& seen) {
  const Eigen::Vector3d at = projection * point;
  if (!(std::abs(at.z()) > kNothing)) return std::numeric_limits<double>::infinity();
  return seen.scale * (at.hnormalized() - seen.at).norm();
}

Eigen::Vector4d triangulated(std::span<const Ray> rays, const Eigen::Vector4d* before) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  for (const Ray& ray : rays) {
    const Matrix34& p = ray.projection;
    const double depth = before == nullptr ? p.row(2).head<3>().norm() : p.row(2).dot(*before);
    const double weight = ray.scale / std::max(std::abs(depth), kNothing);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector4d row = weight * (ray.at[k] * p.row(2) - p.row(k)).transpose();
      m += row * row.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(m);
  return eigen.eigenvectors().col(0);
}

// The rays that agree with a point, and their cost.
TriangulatedPoint judged(std::span<const Ray> rays, const Eigen::Vector4d& at, double limit) {
  TriangulatedPoint point{at, {}, 0};
  for (const Ray& ray : rays) {
    const double off = reprojection(ray, at);
    point.agree.push_back(off <= limit);
    if (off <= limit) point.cost += off * off;
  }
  return point;
}

std::size_t votes(const TriangulatedPoint& point) {
  return static_cast<std::size_t>(std::ranges::count(point.agree, true));
}

std::vector<Ray> agreeing(std::span<const Ray> rays, const TriangulatedPoint& point) {
  std::vector<Ray> some;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (point.agree[i]) some.push_back(rays[i]);
  }
  return some;
}

Matrix34 resected(std::span<const SeenPoint> points, const Matrix34* before) {
  Eigen::Matrix<double, 12, 12> m = Eigen::Matrix<double, 12, 12>::Zero();
  for (const SeenPoint& p : points) {
    const double depth = before == nullptr ? 1 : before->row(2).dot(p.point);
    const double weight = 1 / std::max(std::abs(depth), kNothing);
    for (int k = 0; k < 2; ++k) {
      Eigen::Matrix<double, 12, 1> row = Eigen::Matrix<double, 12, 1>::Zero();
      row.segment<4>(4 * k) = weight * p.point;
      row.tail<4>() = -weight * p.seen.at[k] * p.point;
      m += row * row.transpose();
    }
  }
  const Eigen::VectorXd x = least_direction(m);
  Matrix34 projection;
  for (int k = 0; k < 3; ++k) projection.row(k) = x.segment<4>(4 * k).transpose();
  return projection;
}

}  // namespace

double reprojection(const Ray& ray, const Eigen::Vector4d& point) {
  return distance(ray.projection, point, {ray.at, ray.scale});
}

Eigen::Vector4d triangulate(std::span<const Ray> rays) {
  const Eigen::Vector4d first = triangulated(rays, nullptr);
  return triangulated(rays, &first);
}

std::optional<TriangulatedPoint> agreed_point(std::span<const Ray> rays, double limit) {
  constexpr std::size_t kMostProposals = 12;  // with a fifth of the rays wrong one is good for sure
  const std::size_t n = rays.size();
  std::vector<TriangulatedPoint> proposals;
  for (std::size_t step = 1; step < n; ++step) {
    for (std::size_t i = 0; i + step < n && proposals.size() < kMostProposals; ++i) {
      const Ray pair[] = {rays[i], rays[i + step]};
      TriangulatedPoint point = judged(rays, triangulate(pair), limit);
      if (!point.agree[i] || !point.agree[i + step]) continue;
      if (votes(point) > 2) point = judged(rays, triangulate(agreeing(rays, point)), limit);
      if (votes(point) >= 2) proposals.push_back(std::move(point));
    }
  }
  if (proposals.empty()) return std::nullopt;
  const auto best = std::ranges::max_element(
      proposals, {}, [](const TriangulatedPoint& p) { return std::pair(votes(p), -p.cost); });
  const bool is_open = votes(*best) == 2 && std::ranges::any_of(proposals, [&](const auto& other) {
                         return other.agree != best->agree;
                       });
  if (is_open) return std::nullopt;
  return *best;
}

std::optional<Matrix34> resect(const std::vector<SeenPoint>& points, double limit) {
  constexpr int kSamples = 60;
  constexpr std::size_t kPoints = 6;
  constexpr int kRounds = 3;
  if (points.size() < kFewestSeen) return std::nullopt;
  const auto agreeing_with = [&](const Matrix34& projection) {
    std::vector<SeenPoint> agree;
    for (const SeenPoint& p : points) {
      if (distance(projection, p.point, p.seen) <= limit) agree.push_back(p);
    }
    return agree;
  };
  Picker picker;
  std::vector<SeenPoint> best;
  for (int sample = 0; sample < kSamples; ++sample) {
    std::vector<SeenPoint> some;
    for (const std::size_t i : picker.pick(kPoints, points.size())) some.push_back(points[i]);
    auto agree = agreeing_with(resected(some, nullptr));
    if (agree.size() > best.size()) best = std::move(agree);
  }
  for (int round = 0; round < kRounds && best.size() >= kFewestSeen; ++round) {
    auto agree = agreeing_with(resect_all(best));
    if (agree.size() <= best.size()) break;
    best = std::move(agree);
  }
  if (best.size() < kFewestSeen) return std::nullopt;
  return resect_all(best);
}

Matrix34 resect_all(std::span<const SeenPoint> points) {
  const Matrix34 first = resected(points, nullptr);
  return resected(points, &first);
}

}  // namespace calvin::rig
