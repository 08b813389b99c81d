// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The epipolar geometry of two cameras that have seen a light, some of it reflections. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/light/tracks.hpp"

namespace calvin::rig {

struct EpipolarGeometry {
  std::size_t a = 0;  // cameras
  std::size_t b = 0;
  Eigen::Matrix3d fundamental;        // at_b^T F at_a = 0, of norm 1
  std::vector<std::size_t> instants;  // that agree with it
  // The share of them that one homography explains too: 1 where the light has stayed in a plane, or
  // the cameras stand at one place, and F is not determined.
  double planar = 0;
};

// Needs this many common instants.
inline constexpr std::size_t kFewestCommon = 12;

// By random samples of eight (R. Hartley, PAMI 19(6), 1997, in RANSAC with MSAC's score: P. Torr,
// A. Zisserman, CVIU 78(1), 2000), each better one fitted again to all that agree. An instant
// agrees where its Sampson distance is within `limit` px. Absent where too few are common or agree.
// The same sightings give the same result.
[[nodiscard]] std::optional<EpipolarGeometry> find_epipolar_geometry(const Tracks& tracks,
                                                                     std::size_t a, std::size_t b,
                                                                     double limit);

}  // namespace calvin::rig
