// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether one of two cameras gives mirrored pictures. A board without names looks like itself in
// them, by other labels, so that each view is a good one and only two cameras contradict each
// other. Internal.
#pragma once

#include <vector>

#include "calvin/rig/board_views.hpp"
#include "calvin/rig/start/links.hpp"

namespace calvin::rig {

// Whether most of the views that two cameras have in common agree as soon as the pictures of one of
// them are taken for mirrored. Which one it is they do not tell.
[[nodiscard]] bool is_mirrored(const std::vector<BoardView>& views,
                               const std::vector<CameraPoints>& cameras, const Link& link);

}  // namespace calvin::rig
