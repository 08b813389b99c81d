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
  distance_ = scene.radius / std::sin(kFieldOfView / 2) / std::clamp(viewpoint.zoom, 0.1, 10.0);
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

std::optional<Pixel> SceneProjection::project(const Eigen::Vector3d& point) const {
  constexpr double kNearest = 0.02;  // of the distance
  const Eigen::Vector3d seen = rotation_ * (point - from_);
  if (seen.z() < kNearest * distance_) return std::nullopt;
  return Pixel{centre_.u + focal_ * seen.x() / seen.z(), centre_.v + focal_ * seen.y() / seen.z()};
}

}  // namespace calvin
