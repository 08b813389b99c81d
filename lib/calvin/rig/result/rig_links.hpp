// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is said of each pair of cameras of a rig. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/rig.hpp"
#include "calvin/rig/clocks/solve_with_clocks.hpp"

namespace calvin::rig {

// How far two cameras are apart, and how their axes lie. `covariance`: over the turns and places of
// all cameras.
[[nodiscard]] RigLink link_between(std::size_t a, std::size_t b,
                                   const std::vector<SE3>& camera_from_rig,
                                   const Eigen::MatrixXd& covariance);

// Of all pairs of cameras that have views in common, with lengths as `camera_from_rig` has them.
[[nodiscard]] std::vector<RigLink> links_of(const JointSolve& one,
                                            const std::vector<Camera>& cameras,
                                            const std::vector<SE3>& camera_from_rig,
                                            const Eigen::MatrixXd& covariance);

[[nodiscard]] std::optional<std::size_t> weakest_of(const std::vector<RigLink>& links);

}  // namespace calvin::rig
