// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Known distances between cameras: they tell how large the boards are in truth, and where the
// cameras stand. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"

namespace calvin::rig {

struct KnownDistance {
  std::size_t a = 0;  // cameras
  std::size_t b = 0;
  double distance = 0;  // m
  double sigma = 0;     // m; 0: exactly
};

struct PlacedCameras {
  std::vector<SE3> rig_from_camera;
  // Of all cameras, 6 each: a turn about the axes of the rig (rad), then the place (m). Zeros for
  // the camera that is the rig.
  Eigen::MatrixXd covariance;
};

struct ScaledCameras {
  PlacedCameras cameras;
  double scale = 1;  // of lengths on the boards, and of the rig with them: true over said
  double sigma = 0;
  // How far each distance was from what cameras and boards said of it before, in sigmas.
  std::vector<double> misses;
};

// What a least squares over places, the scale and the distances would have: `cameras` are its
// optimum without distances, for boards as large as they are said to be, and `board_sigma` is how
// well that is known, of their size. Absent where the distances contradict each other and neither
// they nor the places may give way.
[[nodiscard]] std::optional<ScaledCameras> scale_by(const PlacedCameras& cameras,
                                                    const std::vector<KnownDistance>& distances,
                                                    double board_sigma);

}  // namespace calvin::rig
