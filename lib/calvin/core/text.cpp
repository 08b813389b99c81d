// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parses and prints numbers with std::from_chars and fmt, which know no locale, and splits text.

#include "calvin/core/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace calvin {

namespace {

template <typename T>
std::optional<T> parse_number(std::string_view text) noexcept {
  T value{};
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

constexpr std::string_view kSpace = " \t\r\n\f\v";

}  // namespace

std::optional<double> parse_double(std::string_view text) noexcept {
  const auto value = parse_number<double>(text);
  if (value && !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<int> parse_int(std::string_view text) noexcept { return parse_number<int>(text); }

std::string format_double(double value) {
  if (value == 0) return "0";  // JSON's "-0" is an integer and reads back without its sign
  return fmt::format("{}", value);
}

std::string two_digits(double value) {
  constexpr double kWhole = 10;  // from here on digits before the point are more than two
  return std::abs(value) < kWhole ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

std::string_view trim(std::string_view text) noexcept {
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> fields;
  for (;;) {
    const auto end = text.find(separator);
    fields.push_back(trim(text.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> all;
  for (std::size_t at = text.find_first_not_of(kSpace); at != std::string_view::npos;
       at = text.find_first_not_of(kSpace, at)) {
    const std::size_t end = std::min(text.find_first_of(kSpace, at), text.size());
    all.push_back(text.substr(at, end - at));
    at = end;
  }
  return all;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (const std::string_view part : split(line, ',')) {
    for (const std::string_view field : split(part, ';')) {
      const auto all = words_of(field);
      fields.insert(fields.end(), all.begin(), all.end());
    }
  }
  return fields;
}

}  // namespace calvin
