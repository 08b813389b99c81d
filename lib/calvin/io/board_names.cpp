// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads and writes files of named boards, and resolves a list of board texts and names.

#include "calvin/io/board_names.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/board_shape_io.hpp"
#include "calvin/io/document.hpp"
#include "calvin/io/point_rows.hpp"
#include "calvin/target/board_name.hpp"

namespace calvin {

namespace {

using io::Node;

constexpr std::size_t kMaxNamesBytes = std::size_t{1} << 20;
constexpr std::string_view kBoardsFormat = "calvin-boards";
constexpr std::string_view kExampleFile =
    R"({"format": "calvin-boards", "version": 1, "boards": {"floor": "checkerboard:9x6:25mm"}})";

tl::unexpected<Error> broken(const std::string& path, std::string_view why) {
  return make_error(ErrorCode::kMalformed,
                    fmt::format("'{}' is not a file of board names: {}. A right one is {}.", path,
                                shortened(why, 400), kExampleFile));
}

Node text_node(std::string_view text) { return {Node::Kind::kString, std::string(text), {}, {}}; }

Node empty_file() {
  const Node version = {Node::Kind::kPlain, "1", {}, {}};
  return {Node::Kind::kMap,
          {},
          {"format", "version", "boards"},
          {text_node(kBoardsFormat), version, {Node::Kind::kMap, {}, {}, {}}}};
}

// The text of a board in the map, which stands alone or in an object; null where there is none.
template <typename AnyNode>
AnyNode* text_of(AnyNode& board) {
  AnyNode* text = board.kind == Node::Kind::kMap ? board.find("board") : &board;
  return text != nullptr && text->kind == Node::Kind::kString ? text : nullptr;
}

Status check_names(const std::string& path, const Node& root) {
  const Node* format = root.find("format");
  if (format == nullptr || format->text != kBoardsFormat)
    return broken(path, "its format is another");
  const Node* version = root.find("version");
  const auto number = version != nullptr && version->kind == Node::Kind::kPlain
                          ? parse_int(version->text)
                          : std::nullopt;
  if (!number) return broken(path, "it has no version");
  if (*number != 1) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("'{}' has version {} of its format; this library reads version "
                                  "1.",
                                  path, *number));
  }
  const Node* boards = root.find("boards");
  if (boards == nullptr || boards->kind != Node::Kind::kMap) {
    return broken(path, "it has no boards");
  }
  for (std::size_t i = 0; i < boards->items.size(); ++i) {
    if (text_of(boards->items[i]) == nullptr) {
      return broken(path, fmt::format("'{}' is not a board text", boards->keys[i]));
    }
  }
  return {};
}

// The whole file; its "boards" are a map of texts.
Result<Node> read_names(const std::string& path) {
  const auto bytes = read_file(path, kMaxNamesBytes);
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  auto root = io::parse_json(*bytes);
  if (!root) return broken(path, root.error().message);
  if (Status status = check_names(path, *root); !status) {
    return tl::unexpected<Error>(status.error());
  }
  return root;
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

// FILE.json#NAME, taken apart.
struct BoardPlace {
  std::string path;
  std::string_view name;
};

BoardPlace place_of(std::string_view text) {
  const auto hash = text.rfind('#');
  return {std::string(trim(text.substr(0, hash))), trim(text.substr(hash + 1))};
}

Result<Board> named_board(std::string_view text) {
  const auto [path, name] = place_of(text);
  if (path.empty()) return wrong_board_text(text, "there is no file before the '#'");
  if (name.empty()) return wrong_board_text(text, "there is no name after the '#'");
  const auto boards = list_boards(path);
  if (!boards) return wrong_board_text(text, boards.error().message, boards.error().code);
  const auto it =
      std::find_if(boards->begin(), boards->end(),
                   [&wanted = name](const NamedBoard& board) { return board.name == wanted; });
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
  if (board) return board;
  return make_error(ErrorCode::kMalformed,
                    fmt::format("The board '{}' in '{}' cannot be used. {}", it->name,
                                shortened(path, 400), board.error().message));
}

tl::unexpected<Error> cannot_be_told_apart(std::string_view text, const Board& a, const Board& b) {
  return wrong_board_text(
      text, fmt::format("{} and {} look the same in a picture and cannot be told apart; name "
                        "the one that is used, or take boards of different corners",
                        a.text(), b.text()));
}

// Whether the text is FILE.json#NAME.
bool has_name(std::string_view text) { return text.find('#') != std::string_view::npos; }

constexpr std::string_view kPoints = "points:";

Result<Board> board_of_points(std::string_view text) {
  const std::string path(trim(text.substr(kPoints.size())));
  const auto rows = path.empty() ? Result<std::vector<PointRow>>(
                                       make_error(ErrorCode::kInvalidArgument, "there is no file"))
                                 : read_point_rows(path);
  auto board = rows ? board_of_rows(*rows, path) : tl::unexpected<Error>(rows.error());
  if (board) return board;
  return make_error(
      board.error().code,
      fmt::format("The board text '{}' is wrong: {} A right text is "
                  "'points:plate.txt', of a file with a line 'unit: mm' and a row X Y "
                  "Z for each point.",
                  shortened(text, 200), board.error().message));
}

Result<Board> one_board(std::string_view text) {
  if (trim(text).starts_with(kPoints)) return board_of_points(trim(text));
  return has_name(text) ? named_board(text) : parse_board(text);
}

}  // namespace

Result<std::vector<Board>> parse_boards(std::string_view text) {
  std::vector<Board> boards;
  for (const std::string_view part : split(text, ';')) {
    if (part.empty()) return wrong_board_text(text, "there is no board before or after a ';'");
    auto board = one_board(part);
    if (!board) return tl::unexpected<Error>(board.error());
    // The same board twice: two sheets of it are in view.
    const auto alike = std::find_if(boards.begin(), boards.end(), [&](const Board& b) {
      return b.looks_like(*board) && b != *board;
    });
    if (alike != boards.end()) return cannot_be_told_apart(text, *alike, *board);
    if (boards.size() == kMaxBoards) {
      return wrong_board_text(text, fmt::format("it has more than {} boards", kMaxBoards));
    }
    boards.push_back(*board);
  }
  return boards;
}

bool names_a_file(std::string_view text) {
  return has_name(text) || text.find(kPoints) != std::string_view::npos;
}

Result<std::vector<NamedBoard>> list_boards(const std::string& path) {
  const auto root = read_names(path);
  if (!root) return tl::unexpected<Error>(root.error());
  const Node& boards = *root->find("boards");
  std::vector<NamedBoard> all;
  all.reserve(boards.items.size());
  for (std::size_t i = 0; i < boards.items.size(); ++i) {
    const Node& board = boards.items[i];
    const Node* shape = board.find("shape");
    const Node* views = shape != nullptr ? shape->find("views") : nullptr;
    all.push_back(
        {boards.keys[i], text_of(board)->text, views != nullptr ? views->items.size() : 0});
  }
  return all;
}

Status add_board(const std::string& path, std::string_view name, std::string_view text) {
  if (Status named = check_board_name(name); !named) return named;
  const auto board = parse_board(text);
  if (!board) return tl::unexpected<Error>(board.error());
  auto root = read_names(path);
  if (!root && root.error().code == ErrorCode::kNotFound) {
    root = empty_file();
  }
  if (!root) return tl::unexpected<Error>(root.error());
  Node& boards = *root->find("boards");
  if (Node* known = boards.find(name)) {
    Node* known_text = text_of(*known);
    const auto before = parse_board(known_text->text);
    if (!before || *before != *board) known->erase("shape");
    text_of(*known)->text = board->text();
  } else {
    boards.keys.emplace_back(name);
    boards.items.push_back(text_node(board->text()));
  }
  return write_file(path, io::print_json(*root));
}

Result<std::shared_ptr<const BoardMeasurement>> read_measurement(std::string_view text) {
  for (const std::string_view part : split(text, ';')) {
    if (!has_name(part)) continue;
    const auto board = named_board(part);
    if (!board) return tl::unexpected<Error>(board.error());
    const auto [path, name] = place_of(part);
    const auto root = read_names(path);
    if (!root) return tl::unexpected<Error>(root.error());
    const Node* known = root->find("boards")->find(name);
    const Node* shape = known != nullptr ? known->find("shape") : nullptr;
    if (shape == nullptr) continue;
    auto measured = io::read_shape(*shape, *board);
    if (!measured) {
      return make_error(ErrorCode::kMalformed,
                        fmt::format("The measured shape of the board '{}' in '{}' cannot be used: "
                                    "{}. Measure it anew (calvin-board measure).",
                                    name, shortened(path, 400), measured.error().message));
    }
    return std::make_shared<const BoardMeasurement>(*std::move(measured));
  }
  return std::shared_ptr<const BoardMeasurement>();
}

Status store_measurement(std::string_view named, const BoardMeasurement& measured) {
  if (!has_name(named)) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("'{}' is no name of a board: a measured board is kept under one, "
                                  "FILE.json#NAME.",
                                  named));
  }
  const auto board = named_board(named);
  if (!board) return tl::unexpected<Error>(board.error());
  if (*board != measured.board) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("'{}' is {}, and {} was measured.", named, board->text(),
                                  measured.board.text()));
  }
  const auto [path, name] = place_of(named);
  auto root = read_names(path);
  if (!root) return tl::unexpected<Error>(root.error());
  Node& known = *root->find("boards")->find(name);
  if (known.kind == Node::Kind::kString) {
    known = {Node::Kind::kMap, {}, {"board"}, {text_node(board->text())}};
  }
  Node shape = io::shape_node(measured);
  if (Node* before = known.find("shape"); before != nullptr) {
    // What a newer program keeps with a shape is of the one before.
    *before = std::move(shape);
  } else {
    known.keys.emplace_back("shape");
    known.items.push_back(std::move(shape));
  }
  return write_file(path, io::print_json(*root));
}

}  // namespace calvin
