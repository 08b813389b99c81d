// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector of any board: image -> Observation.
#pragma once

#include <memory>

#include "calvin/core/result.hpp"
#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// kUnsupported where this build has no detector for the board, with a message that says why.
[[nodiscard]] Result<std::unique_ptr<Detector>> make_detector(const Board& board);

}  // namespace calvin
