// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a solve of a rig says of its cameras. Internal.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calvin/core/rig.hpp"
#include "calvin/rig/joint/baselines.hpp"

namespace calvin::rig {

// Poses and covariances of the cameras that have a calibration, which come first in `frames`; `rms`
// in px.
void set_cameras(const std::vector<Calibration>& cameras, const PlacedCameras& frames,
                 const std::vector<double>& rms, Rig& to);

// Their poses and covariances alone.
void set_places(const PlacedCameras& frames, std::vector<RigCamera>& cameras);

// What to look at where the views of a rig do not fit together at all, by its `rms` and those of
// the calibrations of its cameras; absent where they do.
[[nodiscard]] std::optional<std::string> contradiction_remark(const Rig& rig);

}  // namespace calvin::rig
