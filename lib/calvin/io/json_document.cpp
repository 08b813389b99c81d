// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// JSON text <-> Document.

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calvin/core/text.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

namespace {

// The parser is not recursive and stops when a call answers false, so depth costs no stack.
class Handler final : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return builder.scalar(Node::Kind::kNull, {}); }
  bool boolean(bool value) override {
    return builder.scalar(Node::Kind::kPlain, value ? "true" : "false");
  }
  bool number_integer(number_integer_t value) override {
    return builder.scalar(Node::Kind::kPlain, fmt::format("{}", value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return builder.scalar(Node::Kind::kPlain, fmt::format("{}", value));
  }
  // Not `text`: the parser has put the decimal point of the locale into it.
  bool number_float(number_float_t value, const string_t& /*text*/) override {
    return builder.scalar(Node::Kind::kPlain, format_double(value));
  }
  bool string(string_t& value) override {
    return builder.scalar(Node::Kind::kString, std::move(value));
  }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*size*/) override { return builder.begin(Node::Kind::kMap); }
  bool key(string_t& value) override { return builder.key(std::move(value)); }
  bool end_object() override { return builder.end(); }
  bool start_array(std::size_t /*size*/) override { return builder.begin(Node::Kind::kList); }
  bool end_array() override { return builder.end(); }
  bool parse_error(std::size_t position, const std::string& token,
                   const nlohmann::detail::exception& error) override {
    constexpr int kOverflow = 406;
    broken_at = position;
    if (error.id == kOverflow) too_large = token;
    return false;
  }

  DocumentBuilder builder;
  std::optional<std::size_t> broken_at;  // in bytes, counted from 1
  std::optional<std::string> too_large;  // a number there that a double does not hold
};

// The word at a position, as far as it can be shown: ", at 'NaN'"; nothing at the end.
std::string word_at(std::string_view content, std::size_t offset) {
  if (offset >= content.size()) return {};
  std::string word;
  for (const char c : content.substr(offset, 16)) {
    if (c <= ' ' || c == 0x7f || c == ',' || c == '}' || c == ']') break;
    word += c;
  }
  return word.empty() ? word : ", at '" + word + "'";
}

// The code of the character at the front of UTF-8 text that YAML 1.2 does not count as printable,
// or folds as the end of a line (5.1, 5.4); 0 where it is another one, or below U+0020: nlohmann
// writes those as escapes.
unsigned not_printable(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  if (byte(0) == 0x7F) return 0x7F;
  if (byte(0) == 0xC2 && byte(1) < 0xA0) return byte(1);
  if ((byte(0) & 0xF0) != 0xE0) return 0;
  const unsigned code = (byte(0) & 0x0F) << 12 | (byte(1) & 0x3F) << 6 | (byte(2) & 0x3F);
  constexpr std::array<unsigned, 5> kOfThreeBytes = {0x2028, 0x2029, 0xFEFF, 0xFFFE, 0xFFFF};
  const auto at = std::find(kOfThreeBytes.begin(), kOfThreeBytes.end(), code);
  return at == kOfThreeBytes.end() ? 0 : code;
}

// Behind `out`, whose last line is indented by `indent`. A tree is at most kMaxDepth deep.
void print_node(const Node& node, std::size_t indent, std::string& out) {
  if (node.kind != Node::Kind::kList && node.kind != Node::Kind::kMap) {
    out += node.kind == Node::Kind::kNull     ? "null"
           : node.kind == Node::Kind::kString ? json_string(node.text)
                                              : node.text;
    return;
  }
  const bool map = node.kind == Node::Kind::kMap;
  out += map ? '{' : '[';
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    out.append(i == 0 ? "\n" : ",\n").append(indent + 2, ' ');
    if (map) out += json_string(node.keys[i]) + ": ";
    print_node(node.items[i], indent + 2, out);
  }
  if (!node.items.empty()) out.append("\n").append(indent, ' ');
  out += map ? '}' : ']';
}

}  // namespace

std::string json_string(std::string_view text) {
  using Json = nlohmann::json;
  const std::string json = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string printable;
  printable.reserve(json.size());
  for (std::size_t i = 0; i < json.size();) {
    const unsigned code = not_printable(std::string_view(json).substr(i));
    if (code == 0) {
      printable += json[i++];
    } else {
      printable += fmt::format("\\u{:04x}", code);
      i += code < 0x80 ? 1 : code < 0x800 ? 2 : 3;
    }
  }
  return printable;
}

std::string print_json(const Node& root) {
  std::string out;
  print_node(root, 0, out);
  return out + "\n";
}

Result<Node> parse_json(std::string_view content) {
  Handler handler;
  nlohmann::json::sax_parse(content.begin(), content.end(), &handler);
  if (!handler.broken_at) return handler.builder.take();
  const std::size_t offset = *handler.broken_at > 0 ? *handler.broken_at - 1 : 0;
  const std::string where = place(content, offset);
  const std::string_view rest = content.substr(std::min(offset, content.size()));
  std::string why = fmt::format("the JSON is broken {}{}", where, word_at(content, offset));
  if (handler.too_large) {
    why = fmt::format("'{}' is {} {}, which is more than a number can be (1.8e308)",
                      handler.builder.path(), *handler.too_large, where);
  } else if (rest.starts_with("//") || rest.starts_with("/*")) {
    why = fmt::format("it looks like JSON with a comment {}, which JSON does not have: take it out",
                      where);
  }
  return make_error(ErrorCode::kMalformed, std::move(why));
}

}  // namespace calvin::io
