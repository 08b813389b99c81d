// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The view of a camera for given options, and the arithmetic of views.

#include "calvin/remap/view.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "calvin/remap/view_range.hpp"

namespace calvin {

Result<OutputView> output_view(const Camera& source, const ViewOptions& options) {
  const auto range = ViewRange::find(source, options);
  if (!range) return tl::unexpected(range.error());
  return range->view(options);
}

Eigen::Matrix3d camera_from_view(const ViewOptions& options) {
  const auto angle = [](double value) { return std::isfinite(value) ? value : 0.0; };
  return (Eigen::AngleAxisd(angle(options.pan), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(angle(options.tilt), Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(angle(options.roll), Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

Result<Camera> output_camera(const Camera& source, const ViewOptions& options) {
  const auto view = output_view(source, options);
  if (!view) return tl::unexpected(view.error());
  return view->camera.plane();
}

std::optional<Pixel> transfer(const Camera& from, const Camera& to, Pixel pixel) noexcept {
  const auto ray = from.unproject(pixel);
  return ray ? to.project(*ray) : std::nullopt;
}

Result<Camera> reframed(const Camera& camera, const Camera& from, const Camera& to) {
  const double sx = to.fx() / from.fx();
  const double sy = to.fy() / from.fy();
  std::vector<double> values = camera.parameters();
  values[0] *= sx;
  values[1] *= sy;
  values[2] = sx * (values[2] - from.cx()) + to.cx();
  values[3] = sy * (values[3] - from.cy()) + to.cy();
  return Camera::make(camera.model(), to.image_size(), values, sx * camera.skew());
}

Result<Camera> plain_camera(ImageSize size) {
  const double f = std::max(size.width, size.height);
  return Camera::make("pinhole", size, {f, f, (size.width - 1) / 2.0, (size.height - 1) / 2.0});
}

}  // namespace calvin
