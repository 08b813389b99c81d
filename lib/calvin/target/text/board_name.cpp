// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checks the name of a board.

#include "calvin/target/board_name.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"

namespace calvin {

Status check_board_name(std::string_view name, std::size_t longest) {
  if (!name.empty() && name.size() <= longest) {
    const bool separates = std::any_of(
        name.begin(), name.end(), [](char c) { return c == '#' || c == ';' || is_control(c); });
    if (!separates && trim(name) == name && valid_utf8(name) == name) return {};
  }
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("The board name '{}' is wrong: it needs 1 to {} bytes of UTF-8 without "
                  "'#', ';' and control characters and without a space at its ends, like 'floor' "
                  "for checkerboard:9x6:25mm.",
                  shortened(name, kLongestBoardName), longest));
}

}  // namespace calvin
