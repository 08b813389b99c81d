// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A literal of Python -> Document: the dictionaries, lists, tuples, texts and numbers that
// ast.literal_eval() takes. Nothing is run.

#include <fmt/format.h>

#include "calvin/core/utf8.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

namespace {

constexpr std::string_view kBlank = " \t\r\n\f";

class PythonReader {
 public:
  explicit PythonReader(std::string_view text) : text_(text) {}

  Result<Node> read() {
    const bool is_read = value();
    skip_blank();
    if (is_read && at_ < text_.size()) fail("something stands behind its end");
    if (!why_.empty()) return make_error(ErrorCode::kMalformed, why_);
    return builder_.take();
  }

 private:
  // The first thing that is wrong stays.
  bool fail(std::string_view why) {
    if (why_.empty()) {
      why_ = fmt::format("the Python literal is broken {}: {}", place(text_, at_), why);
    }
    return false;
  }

  // What the builder says of a value, where it refuses it.
  bool built(bool is_taken) { return is_taken || fail(refusal()); }
  std::string refusal() {
    const auto taken = builder_.take();
    return taken ? std::string("a value is too many") : taken.error().message;
  }

  [[nodiscard]] char next() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void skip_blank() {
    while (at_ < text_.size()) {
      if (text_[at_] == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (kBlank.find(text_[at_]) != std::string_view::npos) {
        ++at_;
      } else {
        return;
      }
    }
  }

  // Whether a text begins here, after one of the prefixes of bytes, raw and Unicode texts.
  [[nodiscard]] bool is_text() const {
    const std::size_t quote =
        std::string_view("bBrRuU").find(next()) != std::string_view::npos && next() != '\0'
            ? at_ + 1
            : at_;
    return quote < text_.size() && (text_[quote] == '\'' || text_[quote] == '"');
  }

  // Escapes stand for the character that follows: names and encoded bytes need no others.
  bool text(std::string& out) {
    if (text_[at_] != '\'' && text_[at_] != '"') ++at_;
    const char quote = text_[at_++];
    while (next() != quote) {
      if (next() == '\\') ++at_;
      if (at_ >= text_.size() || next() == '\n') return fail("a text has no end");
      out += text_[at_++];
    }
    ++at_;
    skip_blank();
    return true;
  }

  bool word() {
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n\f,:#[](){}", at_), text_.size());
    const std::string_view word = text_.substr(at_, end - at_);
    if (word.empty()) return fail("a value is missing");
    at_ = end;
    if (word == "None") return built(builder_.scalar(Node::Kind::kNull, {}));
    const std::string_view plain = word == "True" ? "true" : word == "False" ? "false" : word;
    return built(builder_.scalar(Node::Kind::kPlain, std::string(plain)));
  }

  // The values between brackets, with or without a comma behind the last one.
  bool items(Node::Kind kind, char close) {
    ++at_;
    if (!built(builder_.begin(kind))) return false;
    for (skip_blank(); next() != close; skip_blank()) {
      if (kind == Node::Kind::kMap && !key()) return false;
      if (!value()) return false;
      skip_blank();
      if (next() == close) break;
      if (next() != ',') return fail(fmt::format("a comma or '{}' is missing", close));
      ++at_;
    }
    ++at_;
    return built(builder_.end());
  }

  bool key() {
    std::string name;
    if (!is_text()) return fail("a key is no text in quotes");
    if (!text(name)) return false;
    if (next() != ':') return fail(fmt::format("'{}' has no value", shortened(name, 40)));
    ++at_;
    return built(builder_.key(std::move(name)));
  }

  // As deep as the builder allows.
  bool value() {
    skip_blank();
    switch (next()) {
      case '{':
        return items(Node::Kind::kMap, '}');
      case '[':
        return items(Node::Kind::kList, ']');
      case '(':
        return items(Node::Kind::kList, ')');
      default:
        break;
    }
    if (!is_text()) return word();
    std::string out;
    // Texts behind each other are one.
    while (is_text()) {
      if (!text(out)) return false;
    }
    return built(builder_.scalar(Node::Kind::kString, std::move(out)));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string why_;
  DocumentBuilder builder_;
};

}  // namespace

Result<Node> parse_python(std::string_view content) { return PythonReader(content).read(); }

}  // namespace calvin::io
