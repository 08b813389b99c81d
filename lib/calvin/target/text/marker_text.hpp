// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The texts of boards with markers: ChArUco boards, AprilGrids, grids and lists of tags. Internal.
#pragma once

#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/text/fields.hpp"

namespace calvin {

// Each takes the fields behind its kind; errors are phrases, as those of refuse_text().
[[nodiscard]] Result<Board> parse_charuco(const Fields& fields);
[[nodiscard]] Result<Board> parse_april_grid(const Fields& fields);
[[nodiscard]] Result<Board> parse_aruco(const Fields& fields);
[[nodiscard]] Result<Board> parse_april_tags(const Fields& fields);

}  // namespace calvin
