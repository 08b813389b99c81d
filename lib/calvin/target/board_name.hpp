// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parts of the text of a board: its name, its lengths, and what is said of a text that names none.
// Internal.
#pragma once

#include <string>
#include <string_view>

#include "calvin/core/result.hpp"

namespace calvin {

// kInvalidArgument for a name that could not stand in the text of boards, a file or a message:
// names have 1 to 64 bytes of UTF-8 without control characters and what separates boards.
[[nodiscard]] Status check_board_name(std::string_view name);

// m -> "25mm", to a nanometre; parse_length() in target/board.hpp reads it.
[[nodiscard]] std::string length_text(double metres);

// `why` is a phrase that continues "The board text '...' is wrong: ".
[[nodiscard]] tl::unexpected<Error> wrong_board_text(std::string_view text, std::string_view why,
                                                     ErrorCode code = ErrorCode::kInvalidArgument);

}  // namespace calvin
