// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// XML text -> Document, in the way OpenCV's FileStorage uses XML: elements called _ make a list,
// words inside an element too, attributes only repeat what the structure says.

#include <algorithm>

#include <fmt/format.h>

#include "calvin/io/document.hpp"
#include "calvin_config.h"

#if CALVIN_HAVE_FORMATS
#include <pugixml.hpp>
#endif

namespace calvin::io {

#if CALVIN_HAVE_FORMATS

namespace {

constexpr std::string_view kSpace = " \t\r\n\f\v";

struct Word {
  std::string text;
  Node::Kind kind = Node::Kind::kPlain;
};

// The words of an element; "quoted ones" may hold spaces.
std::vector<Word> words(std::string_view text) {
  std::vector<Word> all;
  for (;;) {
    const auto begin = text.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return all;
    text.remove_prefix(begin);
    const bool quoted = text.front() == '"';
    if (quoted) text.remove_prefix(1);
    const auto end = std::min(quoted ? text.find('"') : text.find_first_of(kSpace), text.size());
    all.push_back(
        {std::string(text.substr(0, end)), quoted ? Node::Kind::kString : Node::Kind::kPlain});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

bool add_words(DocumentBuilder& builder, std::string_view text) {
  std::vector<Word> all = words(text);
  if (all.empty()) return builder.scalar(Node::Kind::kNull, {});
  if (all.size() == 1) return builder.scalar(all[0].kind, std::move(all[0].text));
  if (!builder.begin(Node::Kind::kList)) return false;
  for (Word& word : all) {
    if (!builder.scalar(word.kind, std::move(word.text))) return false;
  }
  return builder.end();
}

bool add_element(DocumentBuilder& builder, const pugi::xml_node& element) {
  const auto is_element = [](const pugi::xml_node& n) { return n.type() == pugi::node_element; };
  const pugi::xml_node first = element.find_child(is_element);
  if (!first) return add_words(builder, element.child_value());
  const bool list = std::string_view(first.name()) == "_";
  if (!builder.begin(list ? Node::Kind::kList : Node::Kind::kMap)) return false;
  for (const pugi::xml_node& child : element.children()) {
    if (!is_element(child)) continue;
    if (!list && !builder.key(child.name())) return false;
    if (!add_element(builder, child)) return false;
  }
  return builder.end();
}

}  // namespace

Result<Node> parse_xml(std::string_view content) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(
      content.data(), content.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("the XML is broken {}: {}",
                    place(content, static_cast<std::size_t>(result.offset)), result.description()));
  }
  DocumentBuilder builder;
  if (!add_element(builder, document)) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("the XML cannot be read: {}", builder.take().error().message));
  }
  return builder.take();
}

#else

Result<Node> parse_xml(std::string_view /*content*/) {
  return make_error(ErrorCode::kUnsupported,
                    "this build cannot read XML: it was made without yaml-cpp and pugixml. "
                    "Build it with -Dformats=enabled.");
}

#endif

}  // namespace calvin::io
