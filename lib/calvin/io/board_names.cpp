// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads and writes files of named boards, and resolves a list of board texts and names.

#include "calvin/io/board_names.hpp"

#include <algorithm>
#include <exception>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/target/board_error.hpp"

namespace calvin {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMaxNamesBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxName = 64;
constexpr std::string_view kFormat = "calvin-boards";
constexpr std::string_view kExampleFile =
    R"({"format": "calvin-boards", "version": 1, "boards": {"floor": "checkerboard:9x6:25mm"}})";

tl::unexpected<Error> broken(const std::string& path, std::string_view why) {
  return make_error(ErrorCode::kMalformed,
                    fmt::format("'{}' is not a file of board names: {}. A right one is {}.", path,
                                why, kExampleFile));
}

// Anything that nlohmann throws ends here; the others of this file may let it pass.
template <typename Function>
auto without_exceptions(const std::string& path, Function&& function) -> decltype(function()) {
  try {
    return function();
  } catch (const std::exception& error) {
    return broken(path, error.what());
  }
}

Result<ordered_json> read_names(const std::string& path) {
  const auto bytes = read_file(path, kMaxNamesBytes);
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  auto json = ordered_json::parse(*bytes, nullptr, false);
  if (json.is_discarded()) return broken(path, "it is not JSON");
  if (!json.is_object() || !json.contains("format") || json["format"] != kFormat) {
    return broken(path, "its format is another");
  }
  if (!json.contains("version") || !json["version"].is_number_integer()) {
    return broken(path, "it has no version");
  }
  if (json["version"] != 1) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("'{}' has version {} of its format; this library reads version 1.", path,
                    json["version"].dump()));
  }
  if (!json.contains("boards") || !json["boards"].is_object()) {
    return broken(path, "it has no boards");
  }
  for (const auto& [name, text] : json["boards"].items()) {
    if (!text.is_string()) return broken(path, fmt::format("'{}' is not a board text", name));
  }
  return json;
}

Result<std::vector<NamedBoard>> list(const std::string& path) {
  const auto json = read_names(path);
  if (!json) return tl::unexpected<Error>(json.error());
  std::vector<NamedBoard> all;
  for (const auto& [name, text] : (*json)["boards"].items()) {
    all.push_back({name, text.get<std::string>()});
  }
  return all;
}

std::string names_of(const std::vector<NamedBoard>& boards) {
  if (boards.empty()) return "none";
  constexpr std::size_t kEnough = 10;
  std::vector<std::string> names;
  for (const NamedBoard& board : boards) {
    names.push_back(names.size() < kEnough ? "'" + board.name + "'" : "...");
    if (names.size() > kEnough) break;
  }
  return join(names, ", ");
}

Result<Board> named_board(std::string_view text) {
  const auto hash = text.rfind('#');
  const std::string path(trim(text.substr(0, hash)));
  const std::string_view name = trim(text.substr(hash + 1));
  if (path.empty()) return wrong_board_text(text, "there is no file before the '#'");
  if (name.empty()) return wrong_board_text(text, "there is no name after the '#'");
  const auto boards = list_boards(path);
  if (!boards) return wrong_board_text(text, boards.error().message, boards.error().code);
  const auto it = std::find_if(boards->begin(), boards->end(),
                               [name](const NamedBoard& board) { return board.name == name; });
  if (it == boards->end()) {
    return wrong_board_text(
        text, fmt::format("'{}' has no board of that name, it has {}", path, names_of(*boards)),
        ErrorCode::kNotFound);
  }
  if (it->text.find('#') != std::string::npos) {
    return wrong_board_text(text, fmt::format("the name stands for another name, '{}'", it->text),
                            ErrorCode::kMalformed);
  }
  auto board = parse_board(it->text);
  if (!board) return wrong_board_text(text, board.error().message, ErrorCode::kMalformed);
  return board;
}

Status check_name(std::string_view name) {
  const bool control = std::any_of(name.begin(), name.end(),
                                   [](char c) { return c == '#' || c == ';' || is_control(c); });
  if (!name.empty() && name.size() <= kMaxName && !control && trim(name) == name) return {};
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("The board name '{}' is wrong: it needs 1 to {} characters without '#' "
                  "and ';' and without a space at its ends, like 'floor' for "
                  "checkerboard:9x6:25mm.",
                  name, kMaxName));
}

Status add(const std::string& path, std::string_view name, const Board& board) {
  auto json = read_names(path);
  if (!json && json.error().code == ErrorCode::kNotFound) {
    json = ordered_json{{"format", kFormat}, {"version", 1}, {"boards", ordered_json::object()}};
  }
  if (!json) return tl::unexpected<Error>(json.error());
  (*json)["boards"][std::string(name)] = board.text();
  return write_file(path, json->dump(2) + "\n");
}

// In a picture neither the size of the squares nor what counts as a row tells one from the other.
bool look_alike(const Board& a, const Board& b) noexcept {
  return a.kind == b.kind && std::minmax(a.cols, a.rows) == std::minmax(b.cols, b.rows);
}

tl::unexpected<Error> cannot_be_told_apart(std::string_view text, const Board& a, const Board& b) {
  const std::string first = a.text();
  const std::string second = b.text();
  return wrong_board_text(
      text, first == second
                ? fmt::format("it has {} twice, and two boards that look the same cannot be told "
                              "apart; name it once",
                              first)
                : fmt::format("{} and {} look the same in a picture and cannot be told apart; name "
                              "the one that is used, or take boards of different corners",
                              first, second));
}

}  // namespace

Result<std::vector<Board>> parse_boards(std::string_view text) {
  std::vector<Board> boards;
  for (const std::string_view part : split(text, ';')) {
    if (part.empty()) return wrong_board_text(text, "there is no board before or after a ';'");
    auto board = names_a_file(part) ? named_board(part) : parse_board(part);
    if (!board) return tl::unexpected<Error>(board.error());
    const auto alike = std::find_if(boards.begin(), boards.end(),
                                    [&](const Board& b) { return look_alike(b, *board); });
    if (alike != boards.end()) return cannot_be_told_apart(text, *alike, *board);
    if (boards.size() == kMaxBoards) {
      return wrong_board_text(text, fmt::format("it has more than {} boards", kMaxBoards));
    }
    boards.push_back(*board);
  }
  return boards;
}

bool names_a_file(std::string_view text) { return text.find('#') != std::string_view::npos; }

Result<std::vector<NamedBoard>> list_boards(const std::string& path) {
  return without_exceptions(path, [&] { return list(path); });
}

Status add_board(const std::string& path, std::string_view name, std::string_view text) {
  if (Status named = check_name(name); !named) return named;
  const auto board = parse_board(text);
  if (!board) return tl::unexpected<Error>(board.error());
  return without_exceptions(path, [&] { return add(path, name, *board); });
}

}  // namespace calvin
