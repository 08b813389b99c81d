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

// For people, with two digits that count, and never as "1e+02": "0.018", "3.5", "120".
[[nodiscard]] std::string two_digits(double value);

// The fields between separators, white space around each removed; "" gives one empty field.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);
// The fields between white space; none in "".
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text);
// The fields of a row of a table: between white space, commas and semicolons; none in "".
[[nodiscard]] std::vector<std::string_view> fields_of(std::string_view line);
// What split() takes apart: the parts, a separator between each two.
template <typename Range>
[[nodiscard]] std::string join(const Range& parts, std::string_view separator) {
  std::string text;
  std::string_view between;
  for (const auto& part : parts) {
    text.append(between).append(part);
    between = separator;
  }
  return text;
}
[[nodiscard]] std::string_view trim(std::string_view text) noexcept;

// Whether it is a control character of ASCII. A char is signed on x86 only.
[[nodiscard]] constexpr bool is_control(char c) noexcept {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
}

}  // namespace calvin
