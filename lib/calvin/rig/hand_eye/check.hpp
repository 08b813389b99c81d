// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether the poses of a robot can tell where the camera is, and whether they belong to what it has
// seen. Internal.
#pragma once

#include <optional>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/rig/hand_eye/fit.hpp"
#include "calvin/rig/hand_eye/start.hpp"

namespace calvin::rig {

// kInvalidArgument for poses out of range, for noise that is none, and for views of several boards;
// kDegenerate for fewer than 3 views.
[[nodiscard]] Status check_poses(const std::vector<Pose>& base_from_hand);
[[nodiscard]] Status check_noise(const HandEyeTask& task);
[[nodiscard]] Status check_one_board(const std::vector<BoardView>& views);
[[nodiscard]] Status check_enough(const std::vector<BoardView>& views);

// kDegenerate where the hand has not turned, or about one axis only: then the place of the camera
// along that axis could be any. `turn_sigma` is the noise of the turns, rad.
[[nodiscard]] Status check_turns(const std::vector<Sighting>& sightings, EyeSetup setup,
                                 double turn_sigma);

// kDegenerate where the motions of the hand say nothing of the size of the board, as those of a
// hand that was only turned about one point.
[[nodiscard]] Status check_lengths(const std::vector<Sighting>& sightings, EyeSetup setup);

// kDegenerate where the loops do not close, or no start was found; where they would with poses that
// are read otherwise (inverted, mirrored, in another order or unit), the message says so.
[[nodiscard]] Status check_loops(const std::optional<HandEyeStart>& start,
                                 const std::vector<Sighting>& sightings, EyeSetup setup);

}  // namespace calvin::rig
