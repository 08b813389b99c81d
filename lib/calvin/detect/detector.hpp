// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector of any boards: image -> Observations.
#pragma once

#include <memory>
#include <span>

#include "calvin/core/export.hpp"
#include "calvin/core/result.hpp"
#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// A detector of all boards of a list, in one pass through each image; a board that is in the list
// twice is looked for until two sheets of it are found. kUnsupported where this build has no
// detector for one of them, with a message that says why; kInvalidArgument for an empty list.
[[nodiscard]] CALVIN_API Result<std::unique_ptr<Detector>> make_detector(
    std::span<const Board> boards);
[[nodiscard]] CALVIN_API Result<std::unique_ptr<Detector>> make_detector(const Board& board);

}  // namespace calvin
