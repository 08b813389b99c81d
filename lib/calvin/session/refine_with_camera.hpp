// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners refined once the camera is known (J.-Y. Bouguet, Camera Calibration Toolbox, "Recomp.
// corners"), and the solve that refines them.
#pragma once

#include <cstddef>
#include <span>
#include <stop_token>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

// The observation with its corners fitted once more in its patches, from where camera and pose put
// them and along the edges that they predict, bent as the lens bends them. A corner that is not
// found within 1.5 px of its first place, or has no patch, stays where it was; ids and sigmas stay.
[[nodiscard]] Observation refine_with_camera(const Observation& seen, const Board& board,
                                             const Camera& camera, const SE3& camera_from_board);

// That of all views that the solution has used, with its camera and poses.
void refine_with_camera(std::vector<View>& views, const Solution& solution,
                        const std::stop_token& stop = {});

// solve() `runs` times, the corners refined with the solution before, as far as the views
// have patches: fewer times where another run would change nothing. A run that has no solution
// leaves the one before it.
[[nodiscard]] Result<Solution> solve_in_runs(std::span<const View> views, ImageSize image_size,
                                             const SolveOptions& options, int runs,
                                             const std::stop_token& stop = {});

}  // namespace calvin
