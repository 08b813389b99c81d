// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parts of the text of a board: its name, its lengths, and what is said of a text that names none.
// Internal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "calvin/core/result.hpp"

namespace calvin {

// Bytes, of the name of a board in a file of boards, and of the file of a board's points.
inline constexpr std::size_t kLongestBoardName = 64;
inline constexpr std::size_t kLongestPointsPath = 4096;

// kInvalidArgument for a name that could not stand in the text of boards, a file or a message:
// names have 1 to `longest` bytes of UTF-8 without control characters and what separates boards.
[[nodiscard]] Status check_board_name(std::string_view name,
                                      std::size_t longest = kLongestBoardName);

// m -> "25mm", to a nanometre; parse_length() in target/board.hpp reads it.
[[nodiscard]] std::string length_text(double metres);

// `why` is a phrase that continues "The board text '...' is wrong: ".
[[nodiscard]] tl::unexpected<Error> wrong_board_text(std::string_view text, std::string_view why,
                                                     ErrorCode code = ErrorCode::kInvalidArgument);

}  // namespace calvin
