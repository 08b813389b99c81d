// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The measured shape of a board as a part of a file of board names. docs/formats.md. Internal.
#pragma once

#include "calvin/core/result.hpp"
#include "calvin/io/document.hpp"
#include "calvin/target/measured/board_measurement.hpp"

namespace calvin::io {

// {"offsets": [[x, y, z], ..], "own": [[..], ..], "modes": [[..], ..], "views": [[..], ..]}, m.
[[nodiscard]] Node shape_node(const BoardMeasurement& measured);

// kMalformed for what is no shape of this board.
[[nodiscard]] Result<BoardMeasurement> read_shape(const Node& node, const Board& board);

}  // namespace calvin::io
