// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parses the text of one board.

#include "calvin/target/board.hpp"

#include <array>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/board_error.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr int kMaxSide = 200;
constexpr std::string_view kExample =
    "A right text is 'checkerboard:9x6:25mm': 9 by 6 inner corners, squares of 25 mm.";

struct Unit {
  std::string_view name;
  double metres;
};
constexpr std::array<Unit, 5> kUnits = {
    {{"mm", 1e-3}, {"cm", 1e-2}, {"um", 1e-6}, {"in", 0.0254}, {"m", 1}}};

// Kinds of the board text that this version does not know yet.
constexpr std::array<std::string_view, 6> kOtherKinds = {"circles",   "acircles", "charuco",
                                                         "aprilgrid", "points",   "dot"};

constexpr std::size_t kLongest = 100;

// What a user typed, fit for one line of a log.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (is_control(c)) c = '?';
  }
  return text;
}

// Some reasons are whole sentences, taken over from a file's error.
std::string_view without_stop(std::string_view phrase) {
  if (phrase.ends_with('.')) phrase.remove_suffix(1);
  return phrase;
}

}  // namespace

tl::unexpected<Error> wrong_board_text(std::string_view text, std::string_view why,
                                       ErrorCode code) {
  return make_error(
      code, one_line(fmt::format("The board text '{}' is wrong: {}. {}",
                                 text.substr(0, 2 * kLongest), without_stop(why), kExample)));
}

Result<double> parse_length(std::string_view text) {
  for (const Unit& unit : kUnits) {
    if (!text.ends_with(unit.name)) continue;
    const auto number = parse_double(trim(text.substr(0, text.size() - unit.name.size())));
    if (!number) break;
    if (!(*number > 0)) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' is not a positive length", text));
    }
    return *number * unit.metres;
  }
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("'{}' is not a length with a unit (mm, cm, m, in, um), like 25mm", text));
}

Result<Board> parse_board(std::string_view text) {
  if (text.size() > kLongest) return wrong_board_text(text, "it is too long");
  const auto fields = split(text, ':');
  for (const std::string_view kind : kOtherKinds) {
    if (fields[0] == kind) {
      return wrong_board_text(
          text, fmt::format("boards of the kind '{}' are not known to this version", kind));
    }
  }
  if (fields[0].ends_with(".json")) {
    return wrong_board_text(text,
                            "a file of board names needs the name too, as in boards.json#floor");
  }
  if (fields[0] != "checkerboard") {
    return wrong_board_text(text, fmt::format("there is no kind of board called '{}'", fields[0]));
  }
  if (fields.size() != 3)
    return wrong_board_text(text, "it needs a kind, a size in corners and a length");

  const auto sides = split(fields[1], 'x');
  const auto cols = parse_int(sides.front());
  const auto rows = parse_int(sides.back());
  if (sides.size() != 2 || !cols || !rows) {
    return wrong_board_text(text, fmt::format("'{}' is not COLSxROWS", fields[1]));
  }
  if (*cols < 2 || *rows < 2 || *cols > kMaxSide || *rows > kMaxSide || *cols * *rows < 6) {
    return wrong_board_text(text, fmt::format("{}x{} inner corners is out of range (3x2 to {}x{})",
                                              *cols, *rows, kMaxSide, kMaxSide));
  }
  const auto size = parse_length(fields[2]);
  if (!size) return wrong_board_text(text, size.error().message);
  if (*size < 1e-6 || *size > 1000) {
    return wrong_board_text(
        text, fmt::format("squares of {} are out of range (1um to 1000m)", fields[2]));
  }
  return Checkerboard{*cols, *rows, *size};
}

}  // namespace calvin
