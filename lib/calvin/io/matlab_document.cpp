// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What MATLAB and Octave keep variables in as text -> Document: a script of assignments
// (`fc = [ 657.4 ; 657.8 ];`), and what Octave's save() writes. Variables are numbers and small
// matrices; a vector is a list, a matrix a list of rows. Anything else is passed over: nothing is
// run.

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

namespace {

// Matrices with more numbers are corners and pictures.
constexpr std::size_t kMostNumbers = 64;

using Rows = std::vector<std::vector<std::string>>;
using Variables = std::map<std::string, Node, std::less<>>;

Node plain(std::string text) { return {Node::Kind::kPlain, std::move(text), {}, {}}; }

Node list(std::vector<Node> items) { return {Node::Kind::kList, {}, {}, std::move(items)}; }

// kNull for what is no matrix, or too large a one.
Node matrix(const Rows& rows) {
  std::vector<Node> lines;
  std::vector<Node> flat;
  for (const auto& row : rows) {
    if (row.size() != rows.front().size()) return {};
    std::vector<Node> line;
    for (const std::string& number : row) line.push_back(plain(number));
    flat.insert(flat.end(), line.begin(), line.end());
    lines.push_back(list(std::move(line)));
    if (flat.size() > kMostNumbers) return {};
  }
  const bool is_vector = rows.size() <= 1 || rows.front().size() == 1;
  return list(std::move(is_vector ? flat : lines));
}

// None where rows differ in length.
Rows transposed(const Rows& rows) {
  Rows turned(rows.empty() ? 0 : rows.front().size());
  for (const auto& row : rows) {
    if (row.size() != turned.size()) return {};
    for (std::size_t c = 0; c < row.size(); ++c) turned[c].push_back(row[c]);
  }
  return turned;
}

Node document(Variables variables) {
  Node root{Node::Kind::kMap, {}, {}, {}};
  for (auto& [name, value] : variables) {
    root.keys.push_back(name);
    root.items.push_back(std::move(value));
  }
  return root;
}

bool is_number(std::string_view word) {
  return parse_double(word).has_value() || word == "NaN" || word == "Inf" || word == "-Inf";
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

bool is_name(std::string_view word) {
  return !word.empty() && is_letter(word.front()) &&
         std::ranges::all_of(word, [](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

// The statements of a script, one after the other, without their comments. A bracket or a text
// holds what would end a statement elsewhere.
class Script {
 public:
  explicit Script(std::string_view text) : text_(text) {}

  // Whether there was one more.
  bool next(std::string& statement) {
    statement.clear();
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '%' || c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (c == '"' || (c == '\'' && !is_transposed(statement))) {
        skip_text(statement);
      } else if (text_.substr(at_).starts_with("...")) {  // the statement goes on in the next line
        at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1;
      } else {
        ++at_;
        if (c == '[') open_ = open_ == 0 ? at_ : open_;
        if (c == ']') open_ = 0;
        const bool is_end = c == ';' || c == '\n';
        if (is_end && open_ == 0) return true;
        statement += c;
      }
    }
    return !trim(statement).empty();
  }
  // Where a bracket was opened that nothing closes; absent where all is well.
  [[nodiscard]] std::optional<std::size_t> unclosed() const {
    return open_ == 0 ? std::nullopt : std::optional(open_ - 1);
  }

 private:
  // A quote behind a value turns a matrix round.
  static bool is_transposed(const std::string& statement) {
    if (statement.empty()) return false;
    const char c = statement.back();
    return c == ']' || c == ')' || c == '.' || c == '\'' || is_letter(c) || (c >= '0' && c <= '9');
  }
  void skip_text(std::string& statement) {
    const char ends[] = {text_[at_], '\n'};
    const std::size_t end = std::min(text_.find_first_of({ends, 2}, at_ + 1), text_.size() - 1);
    statement += text_.substr(at_, end + 1 - at_);
    at_ = end + 1;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t open_ = 0;  // behind the bracket that is open
};

// The value of an assignment; kNull where it is no number and no matrix of numbers.
Node value_of(std::string_view text) {
  text = trim(text);
  if (is_number(text)) return plain(std::string(text));
  const bool is_transposed = text.ends_with('\'');
  if (is_transposed) text.remove_suffix(1);
  if (!text.starts_with('[') || !text.ends_with(']')) return {};
  text = text.substr(1, text.size() - 2);
  Rows rows;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(";\n"), text.size());
    std::vector<std::string> row;
    for (const std::string_view word : fields_of(text.substr(0, end))) row.emplace_back(word);
    if (!std::ranges::all_of(row, is_number)) return {};
    if (!row.empty()) rows.push_back(std::move(row));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return matrix(is_transposed ? transposed(rows) : rows);
}

// The lines of a file of Octave's, "# name: fc" and its like apart from the values.
class OctaveLines {
 public:
  explicit OctaveLines(std::string_view text) : lines_(split(text, '\n')) {}

  [[nodiscard]] bool at_end() const { return at_ >= lines_.size(); }
  std::string_view take() { return lines_[at_++]; }
  // What a line says of `key`; empty, and the line stays, where it says something else.
  std::string_view take(std::string_view key) {
    const std::string start = fmt::format("# {}:", key);
    if (at_end() || !lines_[at_].starts_with(start)) return {};
    return trim(lines_[at_++].substr(start.size()));
  }

 private:
  std::vector<std::string_view> lines_;
  std::size_t at_ = 0;
};

Node octave_matrix(OctaveLines& lines) {
  const auto count = parse_int(lines.take("rows"));
  const auto columns = parse_int(lines.take("columns"));
  Rows rows;
  for (int r = 0; count && columns && r < *count && !lines.at_end(); ++r) {
    std::vector<std::string> row;
    for (const std::string_view word : words_of(lines.take())) row.emplace_back(word);
    const bool is_row = std::ssize(row) == *columns && std::ranges::all_of(row, is_number);
    if (!is_row) return {};
    rows.push_back(std::move(row));
    if (rows.size() > kMostNumbers) return {};
  }
  return !count || std::ssize(rows) != *count ? Node{} : matrix(rows);
}

}  // namespace

Result<Node> parse_matlab(std::string_view content) {
  Script script(content);
  Variables variables;
  std::string statement;
  while (script.next(statement)) {
    const std::string_view text = statement;
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view name = trim(text.substr(0, equals));
    Node value = value_of(text.substr(equals + 1));
    if (!is_name(name) || value.kind == Node::Kind::kNull) continue;
    variables.insert_or_assign(std::string(name), std::move(value));
  }
  if (const auto open = script.unclosed()) {
    return make_error(ErrorCode::kMalformed, fmt::format("a bracket is opened {} and never closed",
                                                         place(content, *open)));
  }
  return document(std::move(variables));
}

Result<Node> parse_octave(std::string_view content) {
  OctaveLines lines(content);
  Variables variables;
  while (!lines.at_end()) {
    const std::string_view name = lines.take("name");
    if (!is_name(name)) {
      if (!lines.at_end()) (void)lines.take();
      continue;
    }
    const std::string_view type = lines.take("type");
    Node value;
    if (type == "matrix") value = octave_matrix(lines);
    if (type == "scalar" && !lines.at_end()) {
      const std::string_view number = trim(lines.take());
      if (is_number(number)) value = plain(std::string(number));
    }
    if (value.kind != Node::Kind::kNull) {
      variables.insert_or_assign(std::string(name), std::move(value));
    }
  }
  return document(std::move(variables));
}

}  // namespace calvin::io
