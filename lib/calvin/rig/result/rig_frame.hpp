// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The frame of a rig: another one than that in which its cameras were placed. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/joint/baselines.hpp"
#include "calvin/rig/joint/rig_fit.hpp"

namespace calvin::rig {

// All cameras, the first of which is the rig; behind them the board that the frame is to be that
// of, where there is one.
[[nodiscard]] PlacedCameras frames_of(const RigFit& fit);

// Adds a frame that is that of the rig, exactly.
void add_own_frame(PlacedCameras& frames);

// kInvalidArgument where `world` is of another camera than those with these names, with all names,
// and for a turn about no axis and a time that is no number.
[[nodiscard]] Status check_world(const RigWorld& world, const std::vector<std::string>& names);

// Where that camera is not in the rig: a sentence that says so, and there is no wish any more.
[[nodiscard]] std::string drop_world(std::optional<RigWorld>& world);

// The same frames from that which `world` asks for: from the camera of that name, or from the one
// behind those of the cameras. Gives where the frame was before.
[[nodiscard]] SE3 set_world(const RigWorld& world, const std::vector<std::string>& names,
                            PlacedCameras& frames);

// Boards of a rig, from another frame.
void move_boards(const SE3& world_from_rig, std::vector<RigBoard>& boards);

}  // namespace calvin::rig
