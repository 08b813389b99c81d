// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The formulae of the projections, from directions to the plane and back.

#include "calvin/remap/projection.hpp"

#include <cmath>
#include <numbers>

namespace calvin {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMaxTangent = 3.7320508075688772;  // tan(75 degrees), of half an angle too

Pixel along(const Eigen::Vector3d& direction, double radius) {
  const double across = std::hypot(direction.x(), direction.y());
  if (across == 0) return {0, 0};
  return {direction.x() * radius / across, direction.y() * radius / across};
}

Eigen::Vector3d at_angle(Pixel point, double angle) {
  const double radius = std::hypot(point.u, point.v);
  const double across = radius > 0 ? std::sin(angle) / radius : 0;
  return {point.u * across, point.v * across, std::cos(angle)};
}

Eigen::Vector3d at_longitude(double longitude, double tan_latitude) {
  return {std::sin(longitude), tan_latitude, std::cos(longitude)};
}

}  // namespace

double widest(Projection projection) noexcept {
  switch (projection) {
    case Projection::kRectilinear:
      return kMaxTangent;
    case Projection::kStereographic:
    case Projection::kPanini:
      return 2 * kMaxTangent;
    default:
      return kPi;
  }
}

std::optional<Pixel> to_plane(Projection projection, const Eigen::Vector3d& d) noexcept {
  const double across = std::hypot(d.x(), d.y());
  const double angle = std::atan2(across, d.z());
  const double longitude = std::atan2(d.x(), d.z());
  const double level = std::hypot(d.x(), d.z());
  const bool high_latitude = std::abs(d.y()) > kMaxTangent * level;
  switch (projection) {
    case Projection::kRectilinear:
      if (!(d.z() * kMaxTangent >= across)) return std::nullopt;
      return Pixel{d.x() / d.z(), d.y() / d.z()};
    case Projection::kCylindrical:
      if (high_latitude) return std::nullopt;
      return Pixel{longitude, d.y() / level};
    case Projection::kEquirectangular:
      return Pixel{longitude, std::atan2(d.y(), level)};
    case Projection::kStereographic:
      if (angle > kPi * 5 / 6) return std::nullopt;
      return along(d, 2 * std::tan(angle / 2));
    case Projection::kPanini: {
      if (high_latitude || std::abs(longitude) > kPi * 5 / 6) return std::nullopt;
      const double scale = 2 / (1 + std::cos(longitude));
      return Pixel{scale * std::sin(longitude), scale * d.y() / level};
    }
    case Projection::kFisheye:
      return along(d, angle);
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> from_plane(Projection projection, Pixel point) noexcept {
  const double radius = std::hypot(point.u, point.v);
  switch (projection) {
    case Projection::kRectilinear:
      return Eigen::Vector3d(point.u, point.v, 1);
    case Projection::kCylindrical:
      if (std::abs(point.u) > kPi) return std::nullopt;
      return at_longitude(point.u, point.v);
    case Projection::kEquirectangular:
      if (std::abs(point.u) > kPi || std::abs(point.v) > kPi / 2) return std::nullopt;
      return Eigen::Vector3d(std::sin(point.u) * std::cos(point.v), std::sin(point.v),
                             std::cos(point.u) * std::cos(point.v));
    case Projection::kStereographic:
      return at_angle(point, 2 * std::atan(radius / 2));
    case Projection::kPanini: {
      // x = 2 tan(l / 2).
      const double longitude = 2 * std::atan(point.u / 2);
      return at_longitude(longitude, point.v * (1 + std::cos(longitude)) / 2);
    }
    case Projection::kFisheye:
      if (radius > kPi) return std::nullopt;
      return at_angle(point, radius);
  }
  return std::nullopt;
}

}  // namespace calvin
