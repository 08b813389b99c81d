// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the bytes before a parser does.

#include "calvin/io/text_document.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"

namespace calvin::io {

namespace {

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f';
}

Result<Node> parse_document(std::string_view text) {
  const std::string_view content = trim(text);
  // What begins with a comment is JSON to whoever wrote it. Its lines count from the first one on.
  if (content.starts_with('{') || content.starts_with('[') || content.starts_with('/')) {
    return parse_json(text);
  }
  if (content.starts_with('<')) return parse_xml(content);
  return parse_yaml(content);
}

}  // namespace

Result<Node> parse_text_document(std::string_view content) {
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF")) {
    return make_error(ErrorCode::kMalformed, "it is UTF-16 text: save it as UTF-8");
  }
  if (const auto control = std::find_if(content.begin(), content.end(), is_control);
      control != content.end()) {
    return make_error(ErrorCode::kMalformed, fmt::format("it is not text: there is a byte {} in it",
                                                         static_cast<int>(*control)));
  }
  const std::string text = valid_utf8(content);
  if (trim(text).empty()) return make_error(ErrorCode::kMalformed, "it is empty");
  return parse_document(text);
}

}  // namespace calvin::io
