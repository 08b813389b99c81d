// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The tools: before the work, whether the files to write may be written. A forgotten argument moves
// all others by one, and the first input would be taken for the output.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/document.hpp"
#include "calvin/io/file_text.hpp"

namespace output_files {

// What a file of ours calls its format, and what it is.
struct Kind {
  std::string_view format;
  std::string_view noun;
};
inline constexpr Kind kCalibration = {"calvin-calibration", "a calibration"};
inline constexpr Kind kRig = {"calvin-rig", "a rig"};
inline constexpr Kind kZoomTable = {"calvin-zoom", "a zoom table"};
inline constexpr Kind kHandEye = {"calvin-hand-eye", "a hand-eye calibration"};
inline constexpr Kind kObservations = {"calvin-observations", "observations of a board"};
inline constexpr Kind kBoards = {"calvin-boards", "names of boards"};

struct Output {
  std::string path;
  std::vector<Kind> kinds;  // what it may be; none: a file for another program
};

// What JSON calls its format, or the first line of lines of it; empty where that is nothing.
inline std::string format_in(std::string_view content) {
  content = calvin::io::without_byte_order_mark(content);
  auto root = calvin::io::parse_json(content);
  if (!root) root = calvin::io::parse_json(content.substr(0, content.find('\n')));
  const auto* format = root ? root->find("format") : nullptr;
  return format != nullptr ? format->text : "";
}

inline std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// What is in a file that is none of `kinds`, in words; empty where nothing would be lost.
inline std::string other_content(const Output& output) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(output.path, none)) return "";
  const std::string content = content_of(output.path);
  if (calvin::trim(content).empty()) return "";
  const std::string format = format_in(content);
  if (std::ranges::count(output.kinds, format, &Kind::format) > 0) return "";
  for (const Kind& kind : {kCalibration, kRig, kZoomTable, kHandEye, kObservations, kBoards}) {
    if (kind.format == format) return std::string(kind.noun);
  }
  // Which files other programs read cannot be told.
  if (output.kinds.empty()) return "";
  return calvin::parse_calibration(content) ? "a calibration that none of these tools has written"
                                            : "something that this tool does not write";
}

// Why one output cannot go with the inputs and what its file holds; empty where it can.
inline std::string why_not(const Output& output, std::span<const std::string> inputs) {
  for (const std::string& input : inputs) {
    if (!calvin::is_same_file(output.path, input)) continue;
    return fmt::format("'{}' is one of the files to read, and a result would take its place.",
                       output.path);
  }
  const std::string holds = other_content(output);
  if (holds.empty()) return "";
  std::vector<std::string_view> nouns;
  for (const Kind& kind : output.kinds) nouns.push_back(kind.noun);
  return fmt::format("'{}' holds {}, and {} would take its place.", output.path, holds,
                     nouns.empty() ? "an export" : calvin::join(nouns, " or "));
}

// kInvalidArgument where a result would overwrite an input, another result, or a file that holds
// something else than such a result; the message has the order of the arguments, which is the first
// line of `usage`. Pipes and devices take everything. An error, too, where a file could not be
// written.
inline calvin::Status check(std::span<const Output> outputs, std::span<const std::string> inputs,
                            std::string_view usage) {
  constexpr std::string_view kHead = "Usage: ";
  std::string_view order = usage.substr(0, usage.find('\n'));
  if (order.starts_with(kHead)) order.remove_prefix(kHead.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (calvin::is_stream(outputs[i].path)) continue;
    if (auto writable = calvin::check_writable(outputs[i].path); !writable) return writable;
    const bool is_twice = std::ranges::any_of(outputs.first(i), [&](const Output& other) {
      return calvin::is_same_file(outputs[i].path, other.path);
    });
    const std::string why = is_twice ? fmt::format("'{}' is to hold two results.", outputs[i].path)
                                     : why_not(outputs[i], inputs);
    if (why.empty()) continue;
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format("{} Write to another file, or remove this one first. The order is: {}", why,
                    order));
  }
  return {};
}

}  // namespace output_files
