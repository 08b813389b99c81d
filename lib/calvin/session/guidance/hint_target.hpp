// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a board is to be held to do what a hint asks for.
#pragma once

#include <optional>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/session/guidance/view_coverage.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// camera_from_board of a view that does what coverage.hint() asks for, the whole board in the
// picture. Of a few sizes and tilts it is the first one after which another hint follows; where
// there is none, the first one that the picture has room for. Absent for HintKind::kGood, and where
// the picture has room for none.
[[nodiscard]] std::optional<Pose> hint_target(const ViewCoverage& coverage, const Board& board,
                                              const Camera& camera);

// A camera to begin with, while nobody knows better: without distortion, 70 degrees across. Absent
// for a size that no picture has.
[[nodiscard]] std::optional<Camera> nominal_camera(ImageSize size);

}  // namespace calvin
