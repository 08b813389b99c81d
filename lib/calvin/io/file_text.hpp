// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the text of a file becomes what it says, or a sentence that names the file, what is wrong
// with it and what to do. Internal.
#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calvin/core/result.hpp"

namespace calvin::io {

// What a file is to be, in words.
struct FileKind {
  std::string_view text;    // a text of it that no file holds: "The text of a rig"
  std::string_view noun;    // "a rig"
  std::string_view advice;  // a whole sentence
};

// "'left.json' cannot be used as a rig: it is empty. Give a file that calvin-rig has written."
// `name`: of the file; may be empty. `why`: a clause of a parser or a whole sentence.
[[nodiscard]] std::string explain(const FileKind& kind, std::string_view name,
                                  std::string_view why);

// An error of a parser, explained. What is no argument is the content of the file here.
[[nodiscard]] Error explained(const FileKind& kind, std::string_view name, Error error);

// The text without the byte order mark that editors and spreadsheets put before UTF-8.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text) noexcept;

// The lines of a text that is read line by line, without a byte order mark before the first one.
[[nodiscard]] std::vector<std::string_view> lines_of(std::string_view text);

// What `parse` makes of the content, which never throws then; an error is explained.
template <typename T>
[[nodiscard]] Result<T> parse_as(const FileKind& kind, std::string_view name,
                                 Result<T> (*parse)(std::string_view), std::string_view content) {
  Result<T> result;
  try {
    result = parse(content);
  } catch (const std::exception& exception) {  // out of memory, or a parser's own surprise
    result = make_error(ErrorCode::kMalformed, exception.what());
  }
  if (!result) result.error() = explained(kind, name, std::move(result.error()));
  return result;
}

}  // namespace calvin::io
