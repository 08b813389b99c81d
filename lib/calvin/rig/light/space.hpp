// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The Euclidean space of cameras that are known up to a projective map of it, by what their pixels
// are like. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/light/tracks.hpp"

namespace calvin::rig {

// Maps H with P H ~ K [R | t], the most plausible first: pixels are square and without skew, the
// axis meets the middle of the picture, and focal lengths are near 1, each with how far from true
// it may be; those of cameras with `is_known` are 1, and so is all else of them.
//
// One is proposed by the absolute dual quadric Q = H diag(1, 1, 1, 0) H^T, whose image P Q P^T is K
// K^T, a linear problem in Q (M. Pollefeys and others, IJCV 59(3), 2004). Others by a search: focal
// lengths of two cameras give H in closed form (R. Gherardi, A. Fusiello, ECCV 2010), and a grid of
// them is tried. Few cameras leave several, of which pictures have to tell the right one: at most
// `most` are given, with focal lengths that differ.
[[nodiscard]] std::vector<Eigen::Matrix4d> plausible_spaces(
    const std::vector<Matrix34>& projections, const std::vector<bool>& is_known, std::size_t most);

}  // namespace calvin::rig
