// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where boards were shown to a rig, for whoever looks at it. Internal.
#pragma once

#include <vector>

#include "calvin/core/rig.hpp"
#include "calvin/rig/start/rig_start.hpp"

namespace calvin::rig {

// Of all places of boards that are in use some, as far from each other as they can be, in the order
// of the views. `scale`: what lengths of the rig were multiplied with since.
[[nodiscard]] std::vector<RigBoard> shown_boards(const std::vector<RigCameraViews>& seen,
                                                 const std::vector<BoardView>& views,
                                                 const RigPlaces& places, double scale);

}  // namespace calvin::rig
