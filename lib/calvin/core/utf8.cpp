// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Replaces bytes that are no UTF-8 and shortens text at the border of a character.

#include "calvin/core/utf8.hpp"

#include <cstdint>

#include "calvin/core/text.hpp"

namespace calvin {

namespace {

// Bytes of the character at the front, 0 where it is not valid: cut off, overlong, a surrogate or
// past U+10FFFF (RFC 3629).
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < length) return 0;
  std::uint32_t code = byte(0) & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3FU);
  }
  constexpr std::uint32_t kSmallest[5] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < kSmallest[length] || surrogate || code > 0x10FFFF ? 0 : length;
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  std::string valid;
  valid.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    if (length == 0) {
      valid += '?';
      text.remove_prefix(1);
    } else {
      valid += text.substr(0, length);
      text.remove_prefix(length);
    }
  }
  return valid;
}

std::string shortened(std::string_view text, std::size_t length) {
  std::string result = valid_utf8(text.substr(0, length + 4));
  while (result.size() > length && (static_cast<unsigned char>(result[length]) & 0xC0) == 0x80) {
    --length;
  }
  if (result.size() > length) result.resize(length);
  for (char& c : result) {
    if (is_control(c)) c = ' ';
  }
  return text.size() > length ? result + "..." : result;
}

}  // namespace calvin
