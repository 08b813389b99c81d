// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector of a light, or of a wand of three, that is moved before a camera that stands still.
// In a video the light is what becomes brighter than the background that was learnt from the frames
// before: the first frame shows none. In a picture alone it is the one bright thing before a dark
// room.
#pragma once

#include <memory>
#include <span>

#include "calvin/core/result.hpp"
#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

// Whether a board is a light.
[[nodiscard]] bool is_light(const Board& board);

// Whether a picture tells the lights of a wand apart.
[[nodiscard]] Status check_light(const Board& board);

// For one light, or one wand, only.
[[nodiscard]] std::unique_ptr<Detector> make_light_detector(std::span<const Board> boards);

}  // namespace calvin::detect
