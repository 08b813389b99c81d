// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pose of one board before a known camera.
#pragma once

#include <span>

#include "calvin/camera/camera.hpp"
#include "calvin/core/export.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

struct PoseQuality {
  double rms = 0;        // px, as in docs/conventions.md
  double other_rms = 0;  // px, of the mirrored tilt, at least rms; a board seen small or far fits
                         // both nearly alike
};

// camera_from_board, m: closed form on the rays of the corners, then least squares on their
// reprojection. A plane has two poses that look nearly alike, tilted to either side of the line of
// sight (T. Collins, A. Bartoli, Infinitesimal Plane-Based Pose Estimation, IJCV 109(3), 2014);
// both are refined and the better one is returned. Corners that no ray of the camera leads to are
// left out. kInvalidArgument for a broken observation, kDegenerate where fewer than 4 corners are
// left or all lie on one line. `warp`: how the board is bent.
[[nodiscard]] CALVIN_API Result<SE3> solve_pose(const Camera& camera, const Board& board,
                                                const Observation& observation,
                                                PoseQuality* quality = nullptr,
                                                const BoardWarp& warp = {});

// ---- Internal, and not exported

// Whether nothing of the camera is to be estimated: `fix` has the word "all".
[[nodiscard]] bool holds_camera(const SolveOptions& options);

// kInvalidArgument where the whole camera is held and `initial` does not tell it, or `method` is to
// find another one.
[[nodiscard]] Status check_held_camera(const SolveOptions& options);

// The poses of all views before the camera that `initial` tells, each by solve_pose(): what solve()
// returns where holds_camera(). The calibration is that camera with what is known of it, but with
// these views, their rms and chi. Views without a pose are rejected; kDegenerate where none is
// left.
[[nodiscard]] Result<Solution> solve_poses(std::span<const View> views, ImageSize size,
                                           const SolveOptions& options);

}  // namespace calvin
