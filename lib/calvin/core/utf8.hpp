// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Text from outside made fit for messages and files.
#pragma once

#include <string>
#include <string_view>

namespace calvin {

// The text with every byte that is not part of valid UTF-8 replaced by '?'.
[[nodiscard]] std::string valid_utf8(std::string_view text);

// At most about `length` bytes of valid UTF-8, control characters replaced: for messages.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t length);

}  // namespace calvin
