// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the bytes before a parser does.

#include "calvin/io/text_document.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/file_text.hpp"

namespace calvin::io {

namespace {

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f';
}

// What follows the comments and blank lines at the front.
std::string_view behind_comments(std::string_view content) {
  content = trim(content);
  while (content.starts_with('#')) {
    content = trim(content.substr(std::min(content.find('\n'), content.size())));
  }
  return content;
}

// A dictionary of Python. It is told from JSON by its quotes, or by the comments before it.
bool is_python(std::string_view content) {
  const std::string_view begin = behind_comments(content);
  if (!begin.starts_with('{')) return false;
  return begin.size() < trim(content).size() || behind_comments(begin.substr(1)).starts_with('\'');
}

// It begins with the name of a table alone in its line, or with a key and its value.
bool is_toml(std::string_view content) {
  constexpr std::string_view kKey =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";
  std::string_view line = behind_comments(content);
  line = line.substr(0, line.find('\n'));
  line = trim(line.substr(0, line.find('#')));
  if (line.starts_with('[') && line.ends_with(']')) {
    const std::string_view name = trim(line.substr(1, line.size() - 2));
    return name.find_first_not_of(kKey) == std::string_view::npos && !name.empty() &&
           !parse_double(name) && name != "true" && name != "false" && name != "null";
  }
  const auto end = line.find_first_not_of(kKey);
  return end != std::string_view::npos && end > 0 && trim(line.substr(end)).starts_with('=');
}

// It begins with a comment of MATLAB's, which is no directive of YAML's, or with an assignment and
// a semicolon behind it.
bool is_matlab(std::string_view content) {
  if (content.starts_with("%YAML") || content.starts_with("%TAG")) return false;
  if (content.starts_with('%')) return true;
  std::string_view line = content.substr(0, content.find('\n'));
  line = trim(line.substr(0, line.find('%')));
  const auto equals = line.find('=');
  return equals != std::string_view::npos && line.ends_with(';') &&
         line.find_first_of("{:<\"") > equals;
}

// Of any version of MATLAB that begins with words, or of Octave.
bool is_binary_mat(std::string_view content) {
  const std::string_view begin = content.substr(0, 32);
  return (begin.starts_with("MATLAB ") && begin.find("MAT-file") != std::string_view::npos) ||
         begin.starts_with("Octave-1-");
}

bool is_octave(std::string_view content) {
  return content.starts_with("# Created by Octave") || content.starts_with("# name:");
}

Result<Node> parse_document(std::string_view text) {
  const std::string_view content = trim(text);
  // Lines count from the first one on.
  if (is_octave(content)) return parse_octave(content);
  if (is_matlab(content)) return parse_matlab(text);
  if (is_python(content)) return parse_python(text);
  if (is_toml(content)) return parse_toml(text);
  // What begins with a comment is JSON to whoever wrote it.
  if (content.starts_with('{') || content.starts_with('[') || content.starts_with('/')) {
    return parse_json(text);
  }
  if (content.starts_with('<')) return parse_xml(content);
  return parse_yaml(content);
}

}  // namespace

Result<Node> parse_text_document(std::string_view content) {
  content = without_byte_order_mark(content);
  if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF")) {
    return make_error(ErrorCode::kMalformed, "it is UTF-16 text: save it as UTF-8");
  }
  if (is_binary_mat(content)) {
    return make_error(ErrorCode::kMalformed,
                      "it is a binary file of MATLAB's or Octave's: give the script that Bouguet's "
                      "toolbox writes beside it (Calib_Results.m), or save it as text by Octave "
                      "(load Calib_Results.mat; save -text Calib_Results.txt)");
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
