// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is given of the cameras of a rig, looked at before any of it is solved. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/rig/rig_views.hpp"

namespace calvin::rig {

// The cameras that the calibrations are of. kInvalidArgument for names that are missing or there
// twice, and for numbers or a covariance that no camera has; kUnsupported for an unknown model.
[[nodiscard]] Result<std::vector<Camera>> checked_cameras(const std::vector<RigCameraViews>& seen);

// Why a camera cannot be joined to any other, whatever it has seen: its views have no timestamps
// (kInvalidArgument), or, which counts unless boards are fixed to each other, they are of boards
// that no other camera has seen, or of no time at which another one has seen any, to `tolerance`
// ns, though near to one (kDegenerate). Absent where nothing of it is so.
[[nodiscard]] std::optional<Error> why_apart(const std::vector<RigCameraViews>& seen,
                                             std::size_t camera, bool fixed_boards,
                                             std::uint64_t tolerance);

}  // namespace calvin::rig
