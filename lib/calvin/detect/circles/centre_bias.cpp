// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rim of a disc through a map, and the ellipse that fits it.

#include "calvin/detect/circles/centre_bias.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace calvin::detect {

namespace {

constexpr std::size_t kPoints = 24;
using Rim = std::array<Eigen::Vector2d, kPoints>;

Eigen::Vector2d image_of(const LensMap& map, const Pixel& p) {
  const Pixel image = map.image_of(p);
  return {image.u, image.v};
}

Rim rim_of(const LensMap& map, const Pixel& at, double radius) {
  Rim rim;
  const Rim& circle = unit_circle<kPoints>();
  for (std::size_t k = 0; k < kPoints; ++k) {
    rim[k] = image_of(map, {at.u + radius * circle[k].x(), at.v + radius * circle[k].y()});
  }
  return rim;
}

// What a rim of some radius about a place encloses, by the polygon through every third of its
// points, which is smaller by a factor that all have in common.
double area_of(const LensMap& map, const Pixel& at, double radius) {
  constexpr std::size_t kCorners = kPoints / 3;
  const auto& circle = unit_circle<kCorners>();
  std::array<Eigen::Vector2d, kCorners> rim;
  for (std::size_t k = 0; k < kCorners; ++k) {
    rim[k] = image_of(map, {at.u + radius * circle[k].x(), at.v + radius * circle[k].y()});
  }
  double sum = 0;
  for (std::size_t k = 0; k < kCorners; ++k) {
    const Eigen::Vector2d& a = rim[k];
    const Eigen::Vector2d& b = rim[(k + 1) % kCorners];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  const double angle = 2 * std::numbers::pi / kCorners;
  return 0.5 * std::abs(sum) * angle / std::sin(angle);
}

// The centre of the ellipse |S (p - m)| = 1, S symmetric, that fits points about 0 of about unit
// distance best.
Eigen::Vector2d centre_of(const Rim& points) {
  constexpr int kSteps = 4;
  constexpr double kDone = 1e-6;
  Eigen::Matrix<double, 5, 1> ellipse;  // m, S
  ellipse << 0, 0, 1, 0, 1;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix<double, 5, 5> m = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
    Eigen::Matrix2d s;
    s << ellipse[2], ellipse[3], ellipse[3], ellipse[4];
    for (const Eigen::Vector2d& p : points) {
      const Eigen::Vector2d d = p - ellipse.head<2>();
      const Eigen::Vector2d way = s * d;
      const double length = way.norm();
      const Eigen::Vector2d unit = way / length;
      Eigen::Matrix<double, 5, 1> j;
      j << -s * unit, unit.x() * d.x(), unit.x() * d.y() + unit.y() * d.x(), unit.y() * d.y();
      m += j * j.transpose();
      right += j * (1 - length);
    }
    const Eigen::Matrix<double, 5, 1> change = m.ldlt().solve(right);
    ellipse += change;
    if (change.squaredNorm() < kDone * kDone) break;
  }
  return ellipse.head<2>();
}

}  // namespace

std::optional<Eigen::Vector2d> centre_bias(const LensMap& map, const Pixel& at,
                                           const Ellipse& seen) {
  const Eigen::Vector2d centre = image_of(map, at);
  double radius = 0.25;  // of what is between two discs, at first
  radius *= seen.radius() * std::sqrt(std::numbers::pi / area_of(map, at, radius));
  if (!(radius > 0) || !(radius < 1)) return std::nullopt;
  Rim rim = rim_of(map, at, radius);
  // Measured by the disc itself all directions count alike, however it is foreshortened.
  Eigen::Matrix2d half_axes;
  half_axes << (rim[0] - rim[kPoints / 2]) / 2, (rim[kPoints / 4] - rim[3 * kPoints / 4]) / 2;
  const Eigen::Matrix2d back = half_axes.inverse();
  for (Eigen::Vector2d& p : rim) p = back * (p - centre);
  const Eigen::Vector2d bias = half_axes * centre_of(rim);
  if (!bias.allFinite() || bias.norm() > seen.radius()) return std::nullopt;
  return bias;
}

}  // namespace calvin::detect
