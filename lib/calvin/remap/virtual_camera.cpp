// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rays and pixels of a virtual camera.

#include "calvin/remap/virtual_camera.hpp"

namespace calvin {

std::optional<Eigen::Vector3d> VirtualCamera::ray(Pixel pixel) const noexcept {
  if (!projection_) return camera_.unproject(pixel);
  const auto direction = from_plane(*projection_, {(pixel.u - camera_.cx()) / camera_.fx(),
                                                   (pixel.v - camera_.cy()) / camera_.fy()});
  if (!direction) return std::nullopt;
  return Eigen::Vector3d(camera_from_view_ * *direction);
}

std::optional<Pixel> VirtualCamera::project(const Eigen::Vector3d& direction) const noexcept {
  if (!projection_) return camera_.project(direction);
  const Eigen::Vector3d seen = camera_from_view_.transpose() * direction;
  // The corners of a rectilinear view lie further off its axis than its sides.
  const bool ahead = *projection_ == Projection::kRectilinear && seen.z() > 0;
  const auto point = ahead ? std::optional(Pixel{seen.x() / seen.z(), seen.y() / seen.z()})
                           : to_plane(*projection_, seen);
  if (!point) return std::nullopt;
  return Pixel{camera_.fx() * point->u + camera_.cx(), camera_.fy() * point->v + camera_.cy()};
}

std::optional<Camera> VirtualCamera::model() const {
  if (!projection_ || *projection_ == Projection::kRectilinear) return camera_;
  if (*projection_ != Projection::kFisheye) return std::nullopt;
  std::vector<double> values = camera_.parameters();
  values.insert(values.end(), 4, 0.0);
  const auto camera = Camera::make("fisheye", camera_.image_size(), values);
  return camera ? std::optional(*camera) : std::nullopt;
}

std::optional<Pixel> transfer(const VirtualCamera& from, const VirtualCamera& to,
                              Pixel pixel) noexcept {
  const auto ray = from.ray(pixel);
  return ray ? to.project(*ray) : std::nullopt;
}

bool shows_any(const VirtualCamera& from, const VirtualCamera& to) noexcept {
  constexpr int kPlaces = 32;  // along each side
  const ImageSize seen = from.image_size();
  const ImageSize shown = to.image_size();
  for (int i = 0; i <= kPlaces; ++i) {
    for (int k = 0; k <= kPlaces; ++k) {
      const auto at = transfer(
          to, from, {(shown.width - 1.0) * k / kPlaces, (shown.height - 1.0) * i / kPlaces});
      if (at && at->u > -0.5 && at->v > -0.5 && at->u < seen.width - 0.5 &&
          at->v < seen.height - 0.5) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace calvin
