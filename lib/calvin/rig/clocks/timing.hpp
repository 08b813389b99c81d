// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras that run freely take their pictures at different times, and boards move meanwhile.
// Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/rig/board_views.hpp"

namespace calvin::rig {

// When each view was taken, ns, on the clock of the first camera: its timestamp and the time offset
// of its camera, s (absent: none), all of them later by as much as keeps them from being negative.
[[nodiscard]] std::vector<ViewTimes> view_times(const std::vector<RigCameraViews>& seen,
                                                const std::vector<double>& offsets);

// Takes every corner to where it was in the middle of its instant, where its velocity is known, and
// adds to its sigma what may be wrong with that. Takes views out of their groups that move too far
// to be of use. `groups` are the views of each instant, `times`
// those of view_times().
void allow_for_timing(const std::vector<ViewTimes>& times, std::vector<BoardView>& views,
                      std::vector<std::vector<std::size_t>>& groups);

}  // namespace calvin::rig
