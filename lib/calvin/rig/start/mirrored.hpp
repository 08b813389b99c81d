// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A camera whose pictures are mirrored. A board without names looks like itself in them, by other
// labels: with M the mirror before the camera and F the one between the labels,
// M camera_from_board F is a motion again for points of a plane. What lies off it would be on the
// other side, so that only two cameras contradict each other. Internal.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"

namespace calvin::rig {

enum class Pictures { kAsTheyAre, kMirrored };

// M: no motion, its matrix has the determinant -1. The identity for pictures as they are.
[[nodiscard]] SE3 mirror_before_camera(Pictures pictures);

// F: across the middle of the board upright, level and along both diagonals. One that makes another
// grid of it agrees with nothing. The identity for pictures as they are.
[[nodiscard]] std::vector<SE3> mirrors_of_board(const Eigen::Vector3d& middle, Pictures pictures);

}  // namespace calvin::rig
