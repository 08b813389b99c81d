// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Document: the tree that JSON, YAML, XML, TOML, literals of Python and variables of MATLAB have in
// common, and the checked way into it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"

namespace calvin::io {

// Numbers stay the text of the file until somebody asks for one.
struct Node {
  enum class Kind { kNull, kPlain, kString, kList, kMap };

  Kind kind = Kind::kNull;
  std::string text;               // kPlain (a number, true, an unquoted word) and kString
  std::vector<std::string> keys;  // kMap: of the items, in the order of the file, each once
  std::vector<Node> items;        // kList and kMap

  // The value of a key; nullptr where there is none or this is no map.
  [[nodiscard]] const Node* find(std::string_view key) const noexcept;
  [[nodiscard]] Node* find(std::string_view key) noexcept;
  // Takes a key and its value out of a map, where it is there.
  void erase(std::string_view key);
};

// How deep lists and maps may lie in each other.
inline constexpr std::size_t kMaxDepth = 64;

// What the parsers feed. Every call answers whether to go on: it refuses what no calibration
// holds and what would exhaust memory or stack (nesting, number of values), and repeated keys.
class DocumentBuilder {
 public:
  [[nodiscard]] bool scalar(Node::Kind kind, std::string text);
  [[nodiscard]] bool begin(Node::Kind kind);
  [[nodiscard]] bool key(std::string text);
  [[nodiscard]] bool end();

  // In a map, before a key.
  [[nodiscard]] bool wants_key() const noexcept;
  // Of the value that comes next: "views[3].rms".
  [[nodiscard]] std::string path() const;
  // The finished tree, or the reason for the refusal.
  [[nodiscard]] Result<Node> take();

 private:
  bool add(Node node);
  bool refuse(std::string why);

  std::vector<Node> open_;
  std::optional<Node> root_;
  std::string refusal_;
  int values_ = 0;
};

// One file each. Errors are kMalformed and tell the line; without the formats feature YAML, XML and
// TOML are kUnsupported.
[[nodiscard]] Result<Node> parse_json(std::string_view content);
[[nodiscard]] Result<Node> parse_yaml(std::string_view content);
[[nodiscard]] Result<Node> parse_xml(std::string_view content);
[[nodiscard]] Result<Node> parse_toml(std::string_view content);
// A literal of Python, as mrcal's camera models are.
[[nodiscard]] Result<Node> parse_python(std::string_view content);
// Variables of MATLAB, as a script that assigns them, and as text of Octave's save(): the numbers,
// vectors and small matrices. What else a script does is passed over.
[[nodiscard]] Result<Node> parse_matlab(std::string_view content);
[[nodiscard]] Result<Node> parse_octave(std::string_view content);

// A text as a JSON string, quotes and all, which is a YAML one too: what is not printable in either
// is an escape. Bytes that are no UTF-8 are replaced.
[[nodiscard]] std::string json_string(std::string_view text);

// The inverse of parse_json(): an element a line, indented by two spaces.
[[nodiscard]] std::string print_json(const Node& root);

// "in line 3" for a position in bytes, or that the text ends too early.
[[nodiscard]] std::string place(std::string_view content, std::size_t offset);

// Reads the fields of a map. The first thing that is wrong goes to the `Error`, after which values
// are defaults: check it once, at the end. Fields inside fields share it.
class Fields {
 public:
  Fields(const Node& node, std::string path, std::optional<Error>& error);

  [[nodiscard]] const Node* find(std::string_view key) const noexcept { return node_.find(key); }
  [[nodiscard]] const std::vector<std::string>& keys() const noexcept { return node_.keys; }

  double number(std::string_view key);
  std::optional<double> optional_number(std::string_view key);
  int integer(std::string_view key);
  std::optional<std::uint64_t> optional_time(std::string_view key);
  bool flag(std::string_view key);           // absent: false
  std::string string(std::string_view key);  // quoted
  std::string optional_string(std::string_view key);
  std::string word(std::string_view key);  // quoted or not; absent: empty
  // A list of `count` numbers, any number of them where it is 0; one number is a list of one.
  std::vector<double> numbers(std::string_view key, std::size_t count = 0);
  // A list of lists of `count` numbers each; absent: none.
  std::vector<std::vector<double>> rows(std::string_view key, std::size_t count);
  Fields map(std::string_view key);
  // The elements of a list; absent: none.
  const std::vector<Node>& list(std::string_view key);

  // `why` follows the path of the field: "is not a number".
  void complain(std::string_view key, std::string_view why, ErrorCode code = ErrorCode::kMalformed);
  [[nodiscard]] bool failed() const noexcept { return error_.has_value(); }

 private:
  const Node* required(std::string_view key);
  double to_number(std::string_view key, const Node& node);
  std::vector<double> to_numbers(std::string_view key, const Node& node, std::size_t count);

  const Node& node_;
  std::string path_;  // "views[3]."
  std::optional<Error>& error_;
};

}  // namespace calvin::io
