// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The frame of a rig, as users type it.
#pragma once

#include <optional>
#include <string_view>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"

namespace calvin {

// `CAMERA`, `board`, `board:TIME` (s; of pictures with numbers the number) or `board:last`, and
// then, separated by colons, turns of the axes: `x90`, `y-90`, `z180`. "board:x180" has z point up
// from a board on the floor. An empty text has none. kInvalidArgument, with a right one.
[[nodiscard]] Result<std::optional<RigWorld>> parse_rig_world(std::string_view text);

}  // namespace calvin
