// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// From the corners of a view to their rays. Internal.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calvin/camera/models.hpp"
#include "calvin/solve/points.hpp"

namespace calvin {

// The unit rays of the corners in use, camera frame; zero where the model has none.
template <typename M>
std::vector<Eigen::Vector3d> rays_of(const PointSet& view, const double* parameters, double skew) {
  using Lens = typename M::Lens;
  const double limit = Lens::limit(parameters + 4);
  std::vector<Eigen::Vector3d> rays(view.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    double xy[2];
    xy[1] = (view.uv[i].v - parameters[3]) / parameters[1];
    xy[0] = (view.uv[i].u - parameters[2] - skew * xy[1]) / parameters[0];
    const auto ray = Lens::undistort(parameters + 4, limit, xy);
    if (ray && ray->allFinite()) rays[i] = *ray;
  }
  return rays;
}

}  // namespace calvin
