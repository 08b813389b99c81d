// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The one form of "this board text is wrong", with a right text in it. Internal.
#pragma once

#include <string_view>

#include "calvin/core/result.hpp"

namespace calvin {

// `why` is a phrase that continues "The board text '...' is wrong: ".
[[nodiscard]] tl::unexpected<Error> wrong_board_text(std::string_view text, std::string_view why,
                                                     ErrorCode code = ErrorCode::kInvalidArgument);

}  // namespace calvin
