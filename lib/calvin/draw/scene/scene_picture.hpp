// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A scene as a picture, seen from a place around it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/draw/scene/scene.hpp"

namespace calvin {

// Where a scene is looked at from: around its middle.
struct SceneViewpoint {
  double azimuth = 0.6;     // rad, around the upward direction
  double elevation = 0.45;  // rad, above the ground
  double zoom = 1;          // 1: all of it is in the picture
};

// Where a place of the scene is in a picture; absent for one beside or behind whoever looks.
class SceneProjection {
 public:
  SceneProjection(const Scene& scene, const SceneViewpoint& viewpoint, ImageSize size);

  [[nodiscard]] std::optional<Pixel> project(const Eigen::Vector3d& point) const;
  // A line or the rim of a shape; what is beside or behind whoever looks is cut off. Empty where
  // that is all of it.
  [[nodiscard]] std::vector<Pixel> project(const ScenePath& path) const;
  // m, along the line of sight.
  [[nodiscard]] double depth(const Eigen::Vector3d& point) const;
  [[nodiscard]] double distance() const { return distance_; }  // m, to the middle

 private:
  [[nodiscard]] Eigen::Vector3d to_view(const Eigen::Vector3d& point) const {
    return rotation_ * (point - from_);
  }
  [[nodiscard]] Pixel pixel_of(const Eigen::Vector3d& in_view) const;

  Eigen::Matrix3d rotation_;  // view_from_rig: right, down, ahead
  Eigen::Vector3d from_;      // m, frame of the rig
  double distance_ = 1;
  double nearest_ = 0;  // m, ahead: what is nearer is not seen
  double focal_ = 1;    // px
  Pixel centre_;
};

// Draws over all of a picture of 32 bit pixels, blue first (BGRx). kUnsupported in a build without
// Cairo, kInvalidArgument for a picture that Cairo cannot have.
[[nodiscard]] Status draw_scene(const Scene& scene, const SceneViewpoint& viewpoint, ImageSize size,
                                std::uint8_t* pixels, std::ptrdiff_t stride);

}  // namespace calvin
