// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads and writes observations as JSON lines.

#include "calvin/io/observations.hpp"

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/document.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Node;

constexpr std::string_view kFormat = "calvin-observations";
constexpr int kVersion = 1;

void read_header(Fields& fields, ObservationFile& file) {
  const std::string format = fields.string("format");
  if (!fields.failed() && format != kFormat) {
    fields.complain("format",
                    fmt::format("is '{}'; a file of observations says '{}'", format, kFormat));
  }
  const int version = fields.integer("version");
  if (!fields.failed() && version != kVersion) {
    fields.complain("version",
                    fmt::format("is {}, and this version of the software reads {}; update it, or "
                                "record the observations again",
                                version, kVersion),
                    ErrorCode::kUnsupported);
  }
  file.board = fields.optional_string("board");
}

ImageSize read_size(Fields& fields) {
  const auto size = fields.numbers("image_size", 2);
  for (const double side : size) {
    if (!(side >= 1 && side <= 65536 && side == static_cast<int>(side))) {
      fields.complain("image_size", "is not [width, height] in whole pixels");
      return {};
    }
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

void read_points(Fields& fields, Observation& seen) {
  for (const auto& point : fields.rows("points", 4)) {
    const double id = point[0];
    if (!(id >= 0 && id < 1e8 && id == static_cast<int>(id))) {
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

Observation read_view(Fields& fields, const std::string& board) {
  Observation seen;
  seen.camera = fields.optional_string("camera");
  seen.board = fields.find("board") != nullptr ? fields.string("board") : board;
  seen.timestamp = fields.optional_time("timestamp").value_or(kNoTimestamp);
  seen.image_size = read_size(fields);
  if (!fields.failed()) read_points(fields, seen);
  return seen;
}

// One whole line: the header where it is the first.
Status read_line(std::string_view line, bool first, ObservationFile& file) {
  const auto node = io::parse_json(line);
  if (!node) return tl::unexpected(node.error());
  if (node->kind != Node::Kind::kMap) {
    return make_error(ErrorCode::kMalformed, "it is not an object in { }");
  }
  std::optional<Error> problem;
  Fields fields(*node, "", problem);
  if (first) {
    read_header(fields, file);
  } else if (fields.find("format") != nullptr) {
    return make_error(
        ErrorCode::kMalformed,
        "it is a second header, as where two files are joined: its board may be another");
  } else if (fields.flag("reset")) {
    file.observations.clear();
  } else {
    file.observations.push_back(read_view(fields, file.board));
  }
  if (problem) return tl::unexpected(*problem);
  return {};
}

}  // namespace

Result<ObservationFile> parse_observations(std::string_view content, std::string_view name) {
  ObservationFile file;
  int number = 0;
  while (file.whole_bytes < content.size()) {
    const auto end = content.find('\n', file.whole_bytes);
    if (end == std::string_view::npos) break;  // torn
    const std::string_view line = trim(content.substr(file.whole_bytes, end - file.whole_bytes));
    ++number;
    if (number == 1 || !line.empty()) {
      if (const Status status = read_line(line, number == 1, file); !status) {
        const std::string& why = status.error().message;
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
  return file;
}

Result<ObservationFile> read_observations(const std::filesystem::path& path) {
  const auto content = read_file(path.string());
  if (!content) return tl::unexpected(content.error());
  return parse_observations(*content, path.string());
}

std::string print_observation_header(std::string_view board) {
  return fmt::format("{{\"format\":\"{}\",\"version\":{},\"board\":{}}}\n", kFormat, kVersion,
                     io::json_string(board));
}

std::string print_observation(const Observation& seen, std::string_view board_of_file) {
  std::string line = fmt::format("{{\"camera\":{}", io::json_string(seen.camera));
  if (seen.board != board_of_file)
    line += fmt::format(",\"board\":{}", io::json_string(seen.board));
  if (seen.timestamp != kNoTimestamp) line += fmt::format(",\"timestamp\":{}", seen.timestamp);
  line += fmt::format(",\"image_size\":[{},{}],\"points\":[", seen.image_size.width,
                      seen.image_size.height);
  for (std::size_t i = 0; i < seen.ids.size() && i < seen.uv.size(); ++i) {
    const double sigma = i < seen.sigma.size() && seen.sigma[i] > 0 ? seen.sigma[i] : 1;
    line +=
        fmt::format("{}[{},{},{},{}]", i == 0 ? "" : ",", seen.ids[i], format_double(seen.uv[i].u),
                    format_double(seen.uv[i].v), format_double(sigma));
  }
  return line + "]}\n";
}

std::string print_observations(const ObservationFile& file) {
  std::string text = print_observation_header(file.board);
  for (const Observation& seen : file.observations) text += print_observation(seen, file.board);
  return text;
}

}  // namespace calvin
