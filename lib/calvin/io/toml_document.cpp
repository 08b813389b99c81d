// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// TOML text -> Document, with the tables in the order of the file.

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/document.hpp"
#include "calvin_config.h"

#if CALVIN_HAVE_FORMATS
// Some broken texts get as far as the parser's assertions, which abort a program or, where they are
// off, are taken for true: here they are errors.
namespace calvin::io {
struct BrokenToml {};
[[noreturn]] static void refuse_toml() { throw BrokenToml(); }
}  // namespace calvin::io
#undef NDEBUG
#define TOML_ASSERT(expr) ((expr) ? static_cast<void>(0) : calvin::io::refuse_toml())
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>
#endif

namespace calvin::io {

#if CALVIN_HAVE_FORMATS

namespace {

bool build(const toml::node& node, DocumentBuilder& builder);

// The parser sorts keys; where each value stands it remembers.
bool build_table(const toml::table& table, DocumentBuilder& builder) {
  std::vector<std::pair<std::string_view, const toml::node*>> entries;
  for (const auto& [key, value] : table) entries.emplace_back(key.str(), &value);
  std::ranges::stable_sort(entries, [](const auto& a, const auto& b) {
    return a.second->source().begin < b.second->source().begin;
  });
  if (!builder.begin(Node::Kind::kMap)) return false;
  for (const auto& [key, value] : entries) {
    if (!builder.key(std::string(key)) || !build(*value, builder)) return false;
  }
  return builder.end();
}

bool build_array(const toml::array& array, DocumentBuilder& builder) {
  if (!builder.begin(Node::Kind::kList)) return false;
  for (const toml::node& item : array) {
    if (!build(item, builder)) return false;
  }
  return builder.end();
}

bool build(const toml::node& node, DocumentBuilder& builder) {
  if (const auto* table = node.as_table()) return build_table(*table, builder);
  if (const auto* array = node.as_array()) return build_array(*array, builder);
  if (const auto* text = node.as_string()) {
    return builder.scalar(Node::Kind::kString, text->get());
  }
  std::string plain;
  if (const auto* integer = node.as_integer()) {
    plain = fmt::format("{}", integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    plain = format_double(number->get());
  } else if (const auto* truth = node.as_boolean()) {
    plain = truth->get() ? "true" : "false";
  } else {
    plain = "a time";
  }
  return builder.scalar(Node::Kind::kPlain, std::move(plain));
}

}  // namespace

Result<Node> parse_toml(std::string_view content) {
  DocumentBuilder builder;
  try {
    build_table(toml::parse(content), builder);
  } catch (const toml::parse_error& error) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("the TOML is broken in line {}: {}", error.source().begin.line,
                                  error.description()));
  } catch (const BrokenToml&) {
    return make_error(ErrorCode::kMalformed, "the TOML is broken");
  }
  return builder.take();
}

#else

Result<Node> parse_toml(std::string_view /*content*/) {
  return make_error(ErrorCode::kUnsupported,
                    "this build cannot read TOML: it was made without toml++. Build it with "
                    "-Dformats=enabled.");
}

#endif

}  // namespace calvin::io
