// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts the sentence together, and takes a text apart.

#include "calvin/io/file_text.hpp"

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"

namespace calvin::io {

std::string explain(const FileKind& kind, std::string_view name, std::string_view why) {
  constexpr std::size_t kMost = 400;  // bytes
  const std::string reason = shortened(why, kMost);
  const std::string file =
      name.empty() ? std::string(kind.text) : fmt::format("'{}'", shortened(name, kMost));
  return fmt::format("{} cannot be used as {}: {}{} {}", file, kind.noun, reason,
                     reason.ends_with('.') ? "" : ".", kind.advice);
}

Error explained(const FileKind& kind, std::string_view name, Error error) {
  if (error.code == ErrorCode::kInvalidArgument) error.code = ErrorCode::kMalformed;
  error.message = explain(kind, name, error.message);
  return error;
}

std::string_view without_byte_order_mark(std::string_view text) noexcept {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  return split(without_byte_order_mark(text), '\n');
}

}  // namespace calvin::io
