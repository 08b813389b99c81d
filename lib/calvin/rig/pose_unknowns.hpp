// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How many unknowns the pose of a camera, a board or the rig has. Internal.
#pragma once

#include "calvin/solve/linear/arrowhead.hpp"

namespace calvin::rig {

inline constexpr int kPose = ArrowLayout::kPose;

}  // namespace calvin::rig
