// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// From cameras up to a projective map of space to cameras up to scale: by what pixels are like.
// Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/light/reconstruct.hpp"
#include "calvin/rig/light/tracks.hpp"

namespace calvin::rig {

// Cameras without distortion, whose axes meet the pictures at 0.
struct EuclideanReconstruction {
  std::vector<double> focal;                           // per camera, in the units of the sightings
  std::vector<SE3> camera_from_rig;                    // up to scale; the first camera is the rig
  std::vector<std::optional<Eigen::Vector3d>> points;  // per instant, rig
};

// Under a map of space, of plausible_spaces(), or the identity where projections are motions.
// Cameras with `is_known` have a focal length of 1. kDegenerate where the picture of a camera is
// mirrored, so that the points in front of the others are behind it. `names` are those of the
// cameras.
[[nodiscard]] Result<EuclideanReconstruction> upgrade(const LinearReconstruction& linear,
                                                      const Eigen::Matrix4d& h,
                                                      const std::vector<bool>& is_known,
                                                      const std::vector<std::string>& names);

}  // namespace calvin::rig
