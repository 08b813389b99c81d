// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras that run freely take their pictures at different times, and boards move meanwhile.
// Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/rig/board_views.hpp"

namespace calvin::rig {

// Takes every corner back to where it was when the first picture of its instant was taken, where
// its velocity is known, and adds to its sigma what may be wrong with that. Takes views out of
// their groups that move too far to be of use. `groups` are the views of each instant.
void allow_for_timing(const std::vector<RigCameraViews>& seen, std::vector<BoardView>& views,
                      std::vector<std::vector<std::size_t>>& groups);

}  // namespace calvin::rig
