// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector of grids of dots or lines that go on beyond the picture.
#pragma once

#include <memory>
#include <span>

#include "calvin/detect/detection.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

[[nodiscard]] bool is_unbounded_grid(const Board& board);

// For boards that is_unbounded_grid() tells. One sheet of each is found, the one of which most is
// seen; every image is searched anew.
[[nodiscard]] std::unique_ptr<Detector> make_grid_detector(std::span<const Board> boards);

}  // namespace calvin::detect
