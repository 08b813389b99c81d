// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The camera of a picture: a real one, or a virtual one that has a projection and looks elsewhere.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/remap/projection.hpp"

namespace calvin {

// Immutable. Directions are in the axes of the real camera.
class VirtualCamera {
 public:
  // The camera itself.
  explicit VirtualCamera(Camera camera) : camera_(std::move(camera)) {}
  // Pixels are fx x + cx, fy y + cy of the pinhole `plane`, with (x, y) on the projection's plane.
  VirtualCamera(Projection projection, Camera plane, const Eigen::Matrix3d& camera_from_view)
      : camera_(std::move(plane)), projection_(projection), camera_from_view_(camera_from_view) {}

  [[nodiscard]] ImageSize image_size() const noexcept { return camera_.image_size(); }
  [[nodiscard]] std::optional<Eigen::Vector3d> ray(Pixel pixel) const noexcept;
  // The pixel of a direction, absent where the camera does not see it; it may lie outside of the
  // picture.
  [[nodiscard]] std::optional<Pixel> project(const Eigen::Vector3d& direction) const noexcept;

  // The real camera itself; of a virtual camera the pinhole that lays out its plane.
  [[nodiscard]] const Camera& plane() const noexcept { return camera_; }
  // The camera model of the picture, in axes along the view; absent for projections that no model
  // describes.
  [[nodiscard]] std::optional<Camera> model() const;

 private:
  Camera camera_;
  std::optional<Projection> projection_;
  Eigen::Matrix3d camera_from_view_ = Eigen::Matrix3d::Identity();
};

// px of one camera -> px of another camera at the same position. Absent where the other one does
// not see the ray of the pixel; the result may lie outside of its picture.
[[nodiscard]] std::optional<Pixel> transfer(const VirtualCamera& from, const VirtualCamera& to,
                                            Pixel pixel) noexcept;

// Whether a picture of `to` has anything of one of `from`: looked for at places all over it.
[[nodiscard]] bool shows_any(const VirtualCamera& from, const VirtualCamera& to) noexcept;

}  // namespace calvin
