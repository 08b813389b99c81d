// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Known distances by the names of cameras, and what they say of the boards in words. Internal.
#pragma once

#include <string>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/joint/baselines.hpp"

namespace calvin::rig {

// Of cameras with these names. kInvalidArgument for a name that none has, a distance of a camera to
// itself, one or a sigma that is no length, and one without names where there are not two cameras.
[[nodiscard]] Result<std::vector<KnownDistance>> known_distances(
    const std::vector<CameraBaseline>& baselines, const std::vector<std::string>& names);

// Where some cameras are not in the rig: takes out those that are not of two cameras with these
// names, each with a sentence that says so.
[[nodiscard]] std::vector<std::string> drop_unknown(std::vector<CameraBaseline>& baselines,
                                                    const std::vector<std::string>& names);

// Sentences: that boards are not as large as they are said to be, and which distances contradict
// the others. `cell`: a length on the board that people measure, m.
[[nodiscard]] std::vector<std::string> scale_remarks(const ScaledCameras& scaled,
                                                     const std::vector<KnownDistance>& distances,
                                                     const std::vector<std::string>& names,
                                                     double cell);

}  // namespace calvin::rig
