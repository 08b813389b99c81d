// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras and points up to a projective map of space, from what cameras have seen of a light.
// Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/rig/light/epipolar.hpp"
#include "calvin/rig/light/tracks.hpp"

namespace calvin::rig {

struct LinearReconstruction {
  std::vector<Matrix34> projections;  // per camera
  // Per instant, homogeneous and of norm 1; absent where the cameras do not agree on one.
  std::vector<std::optional<Eigen::Vector4d>> points;
  std::vector<std::vector<bool>> agrees;  // per camera and instant: seen, and no reflection
};

// The points are those of `projections` alone, to `limit` px.
[[nodiscard]] LinearReconstruction triangulate_all(const Tracks& tracks,
                                                   std::vector<Matrix34> projections, double limit);

// The pairs of cameras, those first whose geometry is best determined: by most instants that no
// plane explains. kDegenerate where all pairs leave it open, as with a light that stayed in a
// plane. `names` are those of the cameras, `limit` is in px.
[[nodiscard]] Result<std::vector<EpipolarGeometry>> ranked_pairs(
    const Tracks& tracks, const std::vector<std::string>& names, double limit);

// What is said where a pair's instants lie in a plane.
[[nodiscard]] tl::unexpected<Error> light_in_a_plane();

// From a pair of cameras on: one camera after the other by the points that those before have (P.
// Beardsley, A. Zisserman, D. Murray, IJCV 23(3), 1997), then all points and all cameras in turn.
// With `is_calibrated` coordinates are those of rays at z = 1, so that projections are motions.
// Instants at which a camera has seen nothing are no obstacle, which is what makes factorisation of
// the measurement matrix (P. Sturm, B. Triggs, ECCV 1996; D. Martinec, T. Pajdla, CVPR 2005) want
// its gaps filled first.
// kDegenerate where a camera has too little in common with the others.
[[nodiscard]] Result<LinearReconstruction> reconstruct(const Tracks& tracks,
                                                       const EpipolarGeometry& first,
                                                       const std::vector<std::string>& names,
                                                       bool is_calibrated, double limit);

}  // namespace calvin::rig
