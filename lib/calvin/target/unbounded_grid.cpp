// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text of grids of dots and of lines, and what they are not for.

#include "calvin/target/unbounded_grid.hpp"

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

std::string UnboundedGrid::text() const {
  return fmt::format("{}:{}{}", pattern == GridPattern::kDots ? "dots" : "lines",
                     length_text(pitch), inverted ? ":inverted" : "");
}

Status check_names_points(const Board& board) {
  if (board.as<UnboundedGrid>() == nullptr) return {};
  return make_error(
      ErrorCode::kUnsupported,
      fmt::format("The board {} goes on beyond the picture and has no first point, so that nobody "
                  "knows which of its points several views have in common: it is for a single "
                  "camera. Take a board that names its points, such as puzzle:14x9:20mm.",
                  board.text()));
}

}  // namespace calvin
