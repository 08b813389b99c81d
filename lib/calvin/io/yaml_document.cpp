// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// YAML text -> Document, OpenCV's own header line included.

#include <locale>
#include <sstream>

#include <fmt/format.h>

#include "calvin/io/document.hpp"
#include "calvin_config.h"

#if CALVIN_HAVE_FORMATS
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#endif

namespace calvin::io {

#if CALVIN_HAVE_FORMATS

namespace {

// Thrown through the parser to stop it; never leaves this file.
struct Stop {};

// Events rather than YAML::Node: a tree would follow aliases, and so may grow without bound.
class Handler final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    value(mark, Node::Kind::kNull, "");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    line = mark.line;
    alias = true;
    throw Stop();
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                const std::string& text) override {
    value(mark, tag == "!" ? Node::Kind::kString : Node::Kind::kPlain, text);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {
    go_on(mark.line, builder.begin(Node::Kind::kList));
  }
  void OnSequenceEnd() override { go_on(line, builder.end()); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    go_on(mark.line, builder.begin(Node::Kind::kMap));
  }
  void OnMapEnd() override { go_on(line, builder.end()); }

  DocumentBuilder builder;
  int line = 0;
  bool alias = false;

 private:
  void value(const YAML::Mark& mark, Node::Kind kind, const std::string& text) {
    go_on(mark.line, builder.wants_key() ? builder.key(text) : builder.scalar(kind, text));
  }
  void go_on(int at, bool wanted) {
    line = at;
    if (!wanted) throw Stop();
  }
};

tl::unexpected<Error> broken(int line, std::string_view why) {
  return make_error(ErrorCode::kMalformed,
                    fmt::format("the YAML is broken in line {}: {}", line + 1, why));
}

// The parser keeps 240 bytes of every bracket that is open before it tells of the first one: they
// are counted before, those in quotes too.
bool is_too_deep(std::string_view content) {
  std::size_t depth = 0;
  for (const char c : content) {
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (depth > kMaxDepth) return true;
  }
  return false;
}

}  // namespace

Result<Node> parse_yaml(std::string_view content) {
  if (is_too_deep(content)) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("values are nested more than {} deep", kMaxDepth));
  }
  std::string text(content);
  // "%YAML:1.0" lacks the space that makes a directive.
  if (text.starts_with("%YAML")) text[0] = '#';
  std::istringstream stream(std::move(text));
  stream.imbue(std::locale::classic());
  Handler handler;
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(handler)) {
      return make_error(ErrorCode::kMalformed, "the YAML has no content");
    }
  } catch (const Stop&) {
    if (handler.alias) return broken(handler.line, "anchors and aliases are not read");
    return broken(handler.line, handler.builder.take().error().message);
  } catch (const YAML::Exception& exception) {
    return broken(exception.mark.line, exception.msg);
  }
  return handler.builder.take();
}

#else

Result<Node> parse_yaml(std::string_view content) {
  // What is no other syntax is taken for YAML, but a calibration has fields.
  if (content.find(':') == std::string_view::npos) {
    return make_error(ErrorCode::kMalformed, "it has none of the fields of a calibration");
  }
  return make_error(ErrorCode::kUnsupported,
                    "this build cannot read YAML: it was made without yaml-cpp and pugixml. "
                    "Build it with -Dformats=enabled.");
}

#endif

}  // namespace calvin::io
