// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One pose by least squares, before a known camera. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/loss.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// The unit rays of the corners in use, camera frame; zero where the model has none.
[[nodiscard]] std::vector<Eigen::Vector3d> rays_of(const PointSet& view, const Camera& camera);

// The pose of the linear solution, not refined by distances in the image: of a plane, or of points
// in space.
[[nodiscard]] std::optional<SE3> start_pose(const PointSet& view, const Camera& camera);

// The mirrored_tilt() of the points of a view.
[[nodiscard]] SE3 mirrored_tilt(const PointSet& view, const SE3& camera_from_board);

struct PoseFit {
  SE3 camera_from_board;
  double cost = 0;  // px^2
  // Pose and cost of the mirrored tilt; those of the best where it has no minimum of its own.
  SE3 other;
  double other_cost = 0;
};

// The better of the two minima. Absent where the view determines no pose.
[[nodiscard]] std::optional<PoseFit> fit_pose(const PointSet& view, const Camera& camera,
                                              const Loss& loss);

}  // namespace calvin
