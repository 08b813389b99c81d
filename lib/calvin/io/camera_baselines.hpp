// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Distances between cameras that are known, as users type them.
#pragma once

#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// `A:B:DISTANCE` or `A:B:DISTANCE:SIGMA`, between commas: names of cameras, and lengths with their
// units, "left:right:110.03mm:0.05mm". Of a rig of two cameras `DISTANCE` or `DISTANCE:SIGMA` is
// enough, and the names are empty. An empty text has none. kInvalidArgument, with a right one.
[[nodiscard]] Result<std::vector<CameraBaseline>> parse_camera_baselines(std::string_view text);

}  // namespace calvin
