// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector of grids of tags.
#pragma once

#include <memory>
#include <span>

#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

// Whether a board consists of tags alone.
[[nodiscard]] bool has_tags(const Board& board);

// For such boards only.
[[nodiscard]] std::unique_ptr<Detector> make_tag_detector(std::span<const Board> boards);

}  // namespace calvin::detect
