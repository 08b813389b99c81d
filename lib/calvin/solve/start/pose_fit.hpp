// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One pose by least squares, before a known camera. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/lens_points.hpp"
#include "calvin/solve/residuals/loss.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// The unit rays of the corners in use, camera frame; zero where the model has none.
[[nodiscard]] std::vector<Eigen::Vector3d> rays_of(const PointSet& view, const Camera& camera);
[[nodiscard]] std::vector<Eigen::Vector3d> rays_of(const PointSet& view,
                                                   const CameraPoints& camera);

// The pose of the linear solution, not refined by distances in the image: of a plane, or of points
// in space.
[[nodiscard]] std::optional<SE3> start_pose(const PointSet& view, const Camera& camera);
[[nodiscard]] std::optional<SE3> start_pose(const PointSet& view,
                                            const std::vector<Eigen::Vector3d>& rays);

// A few of a view's corners, ascending: one of each of equal parts of the list, at a different
// place in each part, because a part may be as long as a row of the board.
[[nodiscard]] std::vector<std::size_t> spread_corners(std::size_t all, std::size_t most);

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

// The same to where another least squares starts, from the rays_of() a view: a step that would
// change the cost by less than a thousandth is the last one, and the mirrored tilt is not followed
// to its minimum where that has clearly more than `most` times the cost of the best, and `rounding`
// px^2 per corner more; it is then the best one again, with an infinite cost.
struct RivalTilt {
  double most = 1;
  double rounding = 0;

  [[nodiscard]] double limit(double best, std::size_t corners) const {
    return most * (best + rounding * static_cast<double>(corners));
  }
};
[[nodiscard]] std::optional<PoseFit> fit_pose_roughly(const PointSet& view,
                                                      const std::vector<Eigen::Vector3d>& rays,
                                                      const Camera& camera, const RivalTilt& rival);

}  // namespace calvin
