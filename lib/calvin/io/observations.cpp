// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads and writes observations as JSON lines.

#include "calvin/io/observations.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/document.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Node;

constexpr std::string_view kObservationsFormat = "calvin-observations";
constexpr int kObservationsVersion = 1;
constexpr int kMostId = 100'000'000;
constexpr int kLongestSide = 65536;  // px

void read_header(Fields& fields, ObservationFile& file) {
  const std::string format = fields.string("format");
  if (!fields.failed() && format != kObservationsFormat) {
    fields.complain("format", fmt::format("is '{}'; a file of observations says '{}'", format,
                                          kObservationsFormat));
  }
  const int version = fields.integer("version");
  if (!fields.failed() && version != kObservationsVersion) {
    fields.complain("version",
                    fmt::format("is {}, and this version of the software reads {}; update it, or "
                                "record the observations again",
                                version, kObservationsVersion),
                    ErrorCode::kUnsupported);
  }
  file.board = fields.optional_string("board");
}

ImageSize read_size(Fields& fields) {
  const auto size = fields.numbers("image_size", 2);
  for (const double side : size) {
    if (!(side >= 1 && side <= kLongestSide && side == static_cast<int>(side))) {
      fields.complain("image_size", "is not [width, height] in whole pixels");
      return {};
    }
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

void read_points(Fields& fields, Observation& seen) {
  for (const auto& point : fields.rows("points", 4)) {
    const double id = point[0];
    if (!(id >= 0 && id < kMostId && id == static_cast<int>(id))) {
      fields.complain("points", "has a point whose id is not a whole number from 0");
      return;
    }
    if (!(point[3] > 0)) {
      fields.complain("points", "has a point whose sigma is not positive");
      return;
    }
    seen.ids.push_back(static_cast<int>(id));
    seen.uv.push_back({point[1], point[2]});
    seen.sigma.push_back(point[3]);
  }
}

void read_velocity(Fields& fields, Observation& seen) {
  for (const auto& velocity : fields.rows("velocity", 2)) {
    seen.velocity.push_back({velocity[0], velocity[1]});
  }
  if (!seen.velocity.empty() && seen.velocity.size() != seen.ids.size()) {
    fields.complain("velocity", "is not [u, v] for each point");
  }
}

void read_ambiguous(Fields& fields, Observation& seen) {
  for (const Node& node : fields.list("ambiguous")) {
    const auto relabelling =
        node.kind == Node::Kind::kString ? parse_relabelling(node.text) : std::nullopt;
    if (!relabelling) {
      fields.complain("ambiguous", "has what is no other labelling, as \"rotate180\" is");
      return;
    }
    seen.ambiguous.push_back(*relabelling);
  }
}

void read_blur(Fields& fields, Observation& seen) {
  seen.blur = fields.optional_number("blur").value_or(0);
  if (seen.blur < 0) fields.complain("blur", "is negative");
}

Observation read_view(Fields& fields, const std::string& board) {
  Observation seen;
  seen.camera = fields.optional_string("camera");
  seen.board = fields.find("board") != nullptr ? fields.string("board") : board;
  seen.timestamp = fields.optional_time("timestamp").value_or(kNoTimestamp);
  seen.image_size = read_size(fields);
  if (!fields.failed()) read_points(fields, seen);
  if (!fields.failed()) read_velocity(fields, seen);
  if (!fields.failed()) read_ambiguous(fields, seen);
  if (!fields.failed()) read_blur(fields, seen);
  return seen;
}

// What a line {"reset":true,"views":2} begins: until both are there, the views before it count.
struct Rewrite {
  std::size_t start = 0;  // of its line in the content
  std::vector<Observation> before;
  std::size_t wanted = 0;  // views
};

// Takes lines into a file, of which the caller knows where they begin.
class LineReader {
 public:
  explicit LineReader(ObservationFile& file) : file_(file) {}

  [[nodiscard]] Status read(std::string_view line, bool first, std::size_t start);
  // The end of the content.
  void end();

 private:
  void read_reset(Fields& fields, std::size_t start);

  ObservationFile& file_;
  std::optional<Rewrite> rewrite_;
};

void LineReader::read_reset(Fields& fields, std::size_t start) {
  int views = 0;
  if (fields.find("views") != nullptr) views = fields.integer("views");
  if (views < 0) fields.complain("views", "is negative");
  if (fields.failed()) return;
  std::vector<Observation> before = std::exchange(file_.observations, {});
  rewrite_.reset();
  if (views > 0) rewrite_ = Rewrite{start, std::move(before), static_cast<std::size_t>(views)};
}

void LineReader::end() {
  if (!rewrite_) return;
  file_.observations = std::move(rewrite_->before);
  file_.whole_bytes = rewrite_->start;
}

// One whole line: the header where it is the first.
Status LineReader::read(std::string_view line, bool first, std::size_t start) {
  const auto node = io::parse_json(line);
  if (!node) return tl::unexpected(node.error());
  if (node->kind != Node::Kind::kMap) {
    return make_error(ErrorCode::kMalformed, "it is not an object in { }");
  }
  std::optional<Error> problem;
  Fields fields(*node, "", problem);
  if (first) {
    read_header(fields, file_);
  } else if (fields.find("format") != nullptr) {
    return make_error(
        ErrorCode::kMalformed,
        "it is a second header, as where two files are joined: its board may be another");
  } else if (fields.flag("reset")) {
    read_reset(fields, start);
  } else {
    file_.observations.push_back(read_view(fields, file_.board));
    if (rewrite_ && file_.observations.size() >= rewrite_->wanted) rewrite_.reset();
  }
  if (problem) return tl::unexpected(*problem);
  return {};
}

// What else a file is whose first line is no header; empty where nobody knows.
std::string other_kind(std::string_view content) {
  const auto whole = io::parse_json(content);
  const Node* format = whole ? whole->find("format") : nullptr;
  return format == nullptr ? "" : fmt::format("its 'format' is '{}'", format->text);
}

}  // namespace

Result<ObservationFile> parse_observations(std::string_view content, std::string_view name) {
  ObservationFile file;
  LineReader reader(file);
  int number = 0;
  while (file.whole_bytes < content.size()) {
    const auto end = content.find('\n', file.whole_bytes);
    if (end == std::string_view::npos) break;  // torn
    const std::string_view line = trim(content.substr(file.whole_bytes, end - file.whole_bytes));
    ++number;
    if (number == 1 || !line.empty()) {
      if (const Status status = reader.read(line, number == 1, file.whole_bytes); !status) {
        std::string why = number == 1 ? other_kind(content) : "";
        if (why.empty()) why = status.error().message;
        return make_error(status.error().code,
                          fmt::format("'{}' cannot be used as observations: line {}: {}{} Give a "
                                      "file of observations as calvin writes them, or take this "
                                      "line out.",
                                      name, number, why, why.ends_with('.') ? "" : "."));
      }
    }
    file.whole_bytes = end + 1;
  }
  if (number == 0) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("'{}' holds no observations: its first line, which tells the "
                                  "format and the board, is missing.",
                                  name));
  }
  reader.end();
  return file;
}

Result<ObservationFile> read_observations(const std::filesystem::path& path) {
  const auto content = read_file(path.string(), kMaxObservationBytes);
  if (!content) return tl::unexpected(content.error());
  return parse_observations(*content, path.string());
}

std::string print_observation_header(std::string_view board) {
  return fmt::format("{{\"format\":\"{}\",\"version\":{},\"board\":{}}}\n", kObservationsFormat,
                     kObservationsVersion, io::json_string(board));
}

namespace {

std::string print_velocity(const std::vector<Pixel>& velocity) {
  std::string text;
  for (const Pixel& of : velocity) {
    text +=
        fmt::format("{}[{},{}]", text.empty() ? "" : ",", format_double(of.u), format_double(of.v));
  }
  return fmt::format("[{}]", text);
}

std::string print_ambiguous(const std::vector<Relabelling>& ambiguous) {
  std::string text;
  for (const Relabelling& other : ambiguous) {
    text += fmt::format("{}{}", text.empty() ? "" : ",", io::json_string(to_text(other)));
  }
  return fmt::format("[{}]", text);
}

bool is_side(int side) { return side >= 1 && side <= kLongestSide; }

bool is_finite(const Pixel& p) { return std::isfinite(p.u) && std::isfinite(p.v); }

// Of what no reader takes: what is wrong, as a clause; empty where nothing is.
std::string_view why_unprintable(const Observation& seen) {
  if (!is_side(seen.image_size.width) || !is_side(seen.image_size.height)) {
    return "does not say the size of its image (image_size)";
  }
  if (seen.ids.size() != seen.uv.size()) return "has not as many places as ids";
  const auto is_id = [](int id) { return id >= 0 && id < kMostId; };
  if (!std::ranges::all_of(seen.ids, is_id)) return "has an id that is negative or too large";
  if (!std::ranges::all_of(seen.uv, is_finite)) return "has a corner at a place that is no number";
  if (!seen.velocity.empty() && seen.velocity.size() != seen.uv.size()) {
    return "has velocities of some corners and not of all";
  }
  return std::ranges::all_of(seen.velocity, is_finite) ? "" : "has a velocity that is no number";
}

}  // namespace

std::string print_observation_reset(std::size_t views) {
  return views == 0 ? "{\"reset\":true}\n"
                    : fmt::format("{{\"reset\":true,\"views\":{}}}\n", views);
}

Result<std::string> print_observation(const Observation& seen, std::string_view board_of_file) {
  if (const std::string_view why = why_unprintable(seen); !why.empty()) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("An observation {}, and no program could read it: mend it, or "
                                  "leave it out.",
                                  why));
  }
  std::string line = fmt::format("{{\"camera\":{}", io::json_string(seen.camera));
  if (seen.board != board_of_file)
    line += fmt::format(",\"board\":{}", io::json_string(seen.board));
  if (seen.timestamp != kNoTimestamp) line += fmt::format(",\"timestamp\":{}", seen.timestamp);
  line += fmt::format(",\"image_size\":[{},{}],\"points\":[", seen.image_size.width,
                      seen.image_size.height);
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const bool known = i < seen.sigma.size() && seen.sigma[i] > 0 && std::isfinite(seen.sigma[i]);
    const double sigma = known ? seen.sigma[i] : 1;
    line +=
        fmt::format("{}[{},{},{},{}]", i == 0 ? "" : ",", seen.ids[i], format_double(seen.uv[i].u),
                    format_double(seen.uv[i].v), format_double(sigma));
  }
  line += ']';
  if (!seen.velocity.empty()) line += ",\"velocity\":" + print_velocity(seen.velocity);
  if (!seen.ambiguous.empty()) line += ",\"ambiguous\":" + print_ambiguous(seen.ambiguous);
  if (seen.blur > 0 && std::isfinite(seen.blur))
    line += fmt::format(",\"blur\":{}", format_double(seen.blur));
  return line + "}\n";
}

Result<std::string> print_observations(const ObservationFile& file) {
  std::string text = print_observation_header(file.board);
  for (const Observation& seen : file.observations) {
    const auto line = print_observation(seen, file.board);
    if (!line) return line;
    text += *line;
  }
  return text;
}

}  // namespace calvin
