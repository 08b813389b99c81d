// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The points of a file or of a board that a user is to choose in the picture, or has chosen there.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/session/points/manual_points.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

struct KnownPoints {
  Board board;
  std::vector<PointChoice> seen;  // the points of a file that come with their pixels
  bool is_file = false;           // of points, and no board that a detector finds
};

// A file of points ("plate.txt" or "points:plate.txt", docs/formats.md), or the text of one board.
// Rows of a file that have u and v are pixels chosen already, with their sigma or else kClickSigma.
// An error says what a right text is.
[[nodiscard]] Result<KnownPoints> read_known_points(std::string_view text);

// What clicks choose by the properties `points` and `board`: points of `points` or, where that is
// empty, of a `board` that is a file of points; empty where clicks choose nothing.
[[nodiscard]] std::string points_text(const std::string& points, const std::string& board);

}  // namespace calvin
