// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Numbers in text, independent of the process's locale (gst-launch sets it).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace calvin {

// The whole of `text` as a finite number; absent where anything else is in it.
[[nodiscard]] std::optional<double> parse_double(std::string_view text) noexcept;
[[nodiscard]] std::optional<int> parse_int(std::string_view text) noexcept;

// The shortest text that reads back as the same number: "0.025", "1e-05".
[[nodiscard]] std::string format_double(double value);

// The fields between separators, white space around each removed; "" gives one empty field.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);
[[nodiscard]] std::string_view trim(std::string_view text) noexcept;

}  // namespace calvin
