// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether the cameras of a rig still have the intrinsics that are known of them. Internal.
#pragma once

#include <string>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/rig/rig_views.hpp"

namespace calvin::rig {

// A sentence for each camera whose own views contradict its calibration: of another camera, or of a
// lens that has moved since. A rig that is solved with it fits its views nearly as well as any, and
// its places are off by many of their sigmas.
[[nodiscard]] std::vector<std::string> lens_remarks(const std::vector<RigCameraViews>& seen,
                                                    const std::vector<Camera>& cameras);

}  // namespace calvin::rig
