// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The choice of the functions of a lens, and the rays that these do not find.

#include "calvin/solve/residuals/lens_points.hpp"

#include <algorithm>

#include "calvin/camera/models.hpp"
#include "calvin/solve/linear/aligned.hpp"

namespace calvin {

CameraPoints::CameraPoints(const Camera& camera) : camera_(camera) {
  lens_.parameters = camera.parameters().data();
  lens_.skew = camera.skew();
  visit_model(camera.model(), [&]<typename M>() {
    lens_.limit = M::Lens::limit(lens_.parameters + CameraUnknowns().distortion().first);
    functions_ = lens_point_functions_of<typename M::Lens>();
  });
}

std::vector<Eigen::Vector3d> CameraPoints::rays(std::span<const Pixel> pixels) const {
  std::vector<Eigen::Vector3d> rays(pixels.size());
  const std::size_t padded = (pixels.size() + kLanes - 1) / kLanes * kLanes;
  const AlignedArray arrays = aligned_array(5 * padded);
  double* u = &arrays[0];
  double* v = u + padded;
  double* ray[3] = {v + padded, v + 2 * padded, v + 3 * padded};
  for (std::size_t i = 0; i < padded && !pixels.empty(); ++i) {
    const Pixel& pixel = pixels[std::min(i, pixels.size() - 1)];
    u[i] = pixel.u;
    v[i] = pixel.v;
  }
  functions_.rays(lens_, u, v, ray[0], ray[1], ray[2], padded);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    rays[i] = {ray[0][i], ray[1][i], ray[2][i]};
    if (!rays[i].isZero(0)) continue;
    const auto found = camera_.unproject(pixels[i]);
    if (found && found->allFinite()) rays[i] = *found;
  }
  return rays;
}

}  // namespace calvin
