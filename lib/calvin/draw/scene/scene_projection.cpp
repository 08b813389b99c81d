// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pinhole through which a scene is looked at.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "calvin/draw/scene/scene_picture.hpp"

namespace calvin {

namespace {

constexpr double kFieldOfView = 38 * std::numbers::pi / 180;  // of the shorter side

// How far away one has to be for all of a scene to be in the picture, from any azimuth. A point
// that is r aside and h up is at most x = r cos(a) towards whoever looks, r sin(a) aside of the
// middle of the picture, and h cos(e) - x sin(e) above it, at an elevation e.
double distance_for_all(const Scene& scene, double elevation, double across, double upwards) {
  if (scene.rims.empty()) return scene.radius / std::sin(kFieldOfView / 2);
  constexpr double kMargin = 1.06;  // names stand beside what they name
  const double sine = std::sin(elevation);
  const double cosine = std::cos(elevation);
  double distance = 0;
  for (const Eigen::Vector2d& rim : scene.rims) {
    const double r = rim.x();
    const double h = rim.y();
    distance = std::max(distance, r * std::hypot(1 / across, cosine) + h * sine);
    for (const double x : {-r, r}) {
      distance =
          std::max(distance, std::abs(h * cosine - x * sine) / upwards + x * cosine + h * sine);
    }
  }
  return kMargin * distance;
}

}  // namespace

SceneProjection::SceneProjection(const Scene& scene, const SceneViewpoint& viewpoint,
                                 ImageSize size) {
  const Eigen::Vector3d& up = scene.up;
  const Eigen::Vector3d& x = scene.behind;
  const Eigen::Vector3d y = up.cross(x);
  const double elevation = std::clamp(viewpoint.elevation, -1.5, 1.5);
  const Eigen::Vector3d towards =
      std::cos(elevation) * (std::cos(viewpoint.azimuth) * x + std::sin(viewpoint.azimuth) * y) +
      std::sin(elevation) * up;
  const double tangent = std::tan(kFieldOfView / 2);
  const double shorter = std::min(size.width, size.height);
  distance_ = distance_for_all(scene, elevation, tangent * size.width / shorter,
                               tangent * size.height / shorter) /
              std::clamp(viewpoint.zoom, 0.1, 10.0);
  constexpr double kNearest = 0.02;  // of the distance
  nearest_ = kNearest * distance_;
  from_ = scene.middle + distance_ * towards;
  const Eigen::Vector3d ahead = -towards;
  const Eigen::Vector3d right = ahead.cross(up).normalized();
  rotation_.row(0) = right;
  rotation_.row(1) = ahead.cross(right);
  rotation_.row(2) = ahead;
  focal_ = std::min(size.width, size.height) / 2.0 / std::tan(kFieldOfView / 2);
  centre_ = image_center(size);
}

double SceneProjection::depth(const Eigen::Vector3d& point) const {
  return rotation_.row(2).dot(point - from_);
}

Pixel SceneProjection::pixel_of(const Eigen::Vector3d& in_view) const {
  return {centre_.u + focal_ * in_view.x() / in_view.z(),
          centre_.v + focal_ * in_view.y() / in_view.z()};
}

std::optional<Pixel> SceneProjection::project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d seen = to_view(point);
  if (seen.z() < nearest_) return std::nullopt;
  return pixel_of(seen);
}

// Cut at the plane in front of whoever looks (I. Sutherland, G. Hodgman, Reentrant Polygon
// Clipping, CACM 17(1), 1974). An open line that leaves and comes back is joined along that plane,
// out of sight or nearly so.
std::vector<Pixel> SceneProjection::project(const ScenePath& path) const {
  std::vector<Pixel> pixels;
  const std::size_t count = path.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d to = to_view(path.points[i]);
    const bool has_before = i > 0 || path.is_closed;
    const Eigen::Vector3d from = to_view(path.points[(i + count - 1) % count]);
    if (has_before && (from.z() < nearest_) != (to.z() < nearest_)) {
      const double share = (nearest_ - from.z()) / (to.z() - from.z());
      pixels.push_back(pixel_of(from + share * (to - from)));
    }
    if (to.z() >= nearest_) pixels.push_back(pixel_of(to));
  }
  return pixels;
}

}  // namespace calvin
