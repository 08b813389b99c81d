// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parses the text of one board.

#include "calvin/target/board.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/board_name.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin/target/text/fields.hpp"
#include "calvin/target/text/marker_text.hpp"

namespace calvin {

namespace {

constexpr std::size_t kLongest = 4000;  // bytes: of a hundred tags and more
constexpr std::size_t kShown = 200;     // of a text that is wrong

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

// "2.2+12.2": columns and rows, from 0.
Result<std::vector<GridPlace>> parse_places(std::string_view text) {
  std::vector<GridPlace> places;
  for (const std::string_view place : split(text, '+')) {
    const auto parts = split(place, '.');
    const auto col = parse_int(parts.front());
    const auto row = parse_int(parts.back());
    if (parts.size() != 2 || !col || !row) {
      return refuse_text(fmt::format("'{}' is not COLUMN.ROW", place));
    }
    places.push_back({*col, *row});
  }
  std::ranges::sort(places, {}, [](GridPlace p) { return std::pair(p.row, p.col); });
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

// "circles" or "circles=1.1+1.2+2.1", of a checkerboard.
Result<Board> parse_circles_of(const Checkerboard& squares, std::string_view field) {
  const auto pair = split(field, '=');
  if (pair[0] != "circles" || pair.size() > 2) {
    return refuse_text(
        fmt::format("'{}' is neither 'circles' nor 'circles=COL.ROW+COL.ROW+COL.ROW'", field));
  }
  auto circles = pair.size() == 2 ? parse_places(pair[1])
                                  : MarkedCheckerboard::usual_circles(squares.cols, squares.rows);
  if (!circles) return tl::unexpected(circles.error());
  MarkedCheckerboard board{squares.cols, squares.rows, squares.size, std::move(*circles)};
  if (const Status status = board.check(); !status) return tl::unexpected(status.error());
  return board;
}

Result<Board> parse_checkerboard(const Fields& fields) {
  if (fields.size() != 2 && fields.size() != 3) {
    return refuse_text(
        "it needs a kind, a size in corners, a length and, if it has some, its circles");
  }
  const auto sides = parse_sides(fields[0], "inner corners", 2, 6);
  if (!sides) return tl::unexpected(sides.error());
  const auto size = parse_side(fields[1], "squares");
  if (!size) return tl::unexpected(size.error());
  const Checkerboard board{sides->cols, sides->rows, *size};
  if (fields.size() == 3) return parse_circles_of(board, fields[2]);
  return board;
}

Result<Board> parse_puzzle(const Fields& fields) {
  if (fields.size() != 2 && fields.size() != 3) {
    return refuse_text("it needs a kind, a size in corners, a length and, if not 0,0, its place");
  }
  const auto sides = parse_sides(fields[0], "inner corners", 3, 9);
  if (!sides) return tl::unexpected(sides.error());
  const auto size = parse_side(fields[1], "squares");
  if (!size) return tl::unexpected(size.error());
  PuzzleBoard board{sides->cols, sides->rows, *size};
  if (fields.size() == 3) {
    const auto place = split(fields[2], ',');
    const auto x = parse_int(place.front());
    const auto y = parse_int(place.back());
    constexpr int kMost = PuzzleBoard::kMapSide - 1;
    if (place.size() != 2 || !x || !y || *x < 0 || *y < 0 || *x > kMost || *y > kMost) {
      return refuse_text(
          fmt::format("'{}' is no place x,y of the map (0,0 to {},{})", fields[2], kMost, kMost));
    }
    board.x0 = *x;
    board.y0 = *y;
  }
  return board;
}

// Columns, rows and pitch of discs.
struct Discs {
  Sides sides;
  double pitch = 0;
};
Result<Discs> parse_discs(const Fields& fields) {
  if (fields.size() < 2) return refuse_text("it needs a kind, a size in circles and a distance");
  const auto sides = parse_sides(fields[0], "circles", 2, 6);
  if (!sides) return tl::unexpected(sides.error());
  const auto pitch = parse_side(fields[1], "distances");
  if (!pitch) return tl::unexpected(pitch.error());
  return Discs{*sides, *pitch};
}

template <typename Kind>
Result<Board> parse_circles(const Fields& fields) {
  const auto discs = parse_discs(fields);
  if (!discs) return tl::unexpected(discs.error());
  Kind board;
  board.cols = discs->sides.cols;
  board.rows = discs->sides.rows;
  board.pitch = discs->pitch;
  for (std::size_t i = 2; i < fields.size(); ++i) {
    if (fields[i] != "inverted")
      return refuse_text(fmt::format("'{}' is not 'inverted'", fields[i]));
    board.inverted = true;
  }
  return board;
}

// "dots:1mm", "lines:1mm:inverted".
Result<Board> parse_unbounded(const Fields& fields, GridPattern pattern) {
  if (fields.empty()) return refuse_text("it needs a kind and a distance");
  const auto pitch = parse_side(fields[0], "distances");
  if (!pitch) return tl::unexpected(pitch.error());
  UnboundedGrid board{pattern, *pitch, false};
  for (std::size_t i = 1; i < fields.size(); ++i) {
    if (fields[i] != "inverted")
      return refuse_text(fmt::format("'{}' is not 'inverted'", fields[i]));
    board.inverted = true;
  }
  return board;
}

Result<Board> parse_lines(const Fields& fields) {
  return parse_unbounded(fields, GridPattern::kLines);
}

Result<Board> parse_dots(const Fields& fields) {
  if (!fields.empty() && !is_size(fields[0])) return parse_unbounded(fields, GridPattern::kDots);
  const auto discs = parse_discs(fields);
  if (!discs) return tl::unexpected(discs.error());
  CircleGrid board{discs->sides.cols, discs->sides.rows, discs->pitch, {}, {}, false};
  for (std::size_t i = 2; i < fields.size(); ++i) {
    if (fields[i] == "inverted") {
      board.inverted = true;
      continue;
    }
    const bool is_ring = fields[i].starts_with("rings=");
    if (!is_ring && !fields[i].starts_with("big=")) {
      return refuse_text(fmt::format("'{}' is none of 'rings=', 'big=' and 'inverted'", fields[i]));
    }
    auto places = parse_places(fields[i].substr(fields[i].find('=') + 1));
    if (!places) return tl::unexpected(places.error());
    (is_ring ? board.rings : board.large) = std::move(*places);
  }
  if (const Status status = board.check(); !status) return tl::unexpected(status.error());
  return board;
}

Result<Board> parse_dot(const Fields& fields) {
  if (!fields.empty()) return refuse_text("a light has no measures");
  return PointLight{};
}

// "wand:500mm", "wand:150mm+350mm": from each light to the next.
Result<Board> parse_wand(const Fields& fields) {
  if (fields.size() != 1) {
    return refuse_text("it needs the distances from each light to the next");
  }
  PointLight wand;
  for (const std::string_view distance : split(fields[0], '+')) {
    const auto length = parse_side(distance, "lights");
    if (!length) return tl::unexpected(length.error());
    wand.places.push_back(wand.places.back() + *length);
  }
  if (const Status status = wand.check(); !status) return tl::unexpected(status.error());
  return wand;
}

struct KindOfText {
  std::string_view name;
  Result<Board> (*parse)(const Fields& fields);
  std::string_view example;
};
constexpr std::array<KindOfText, 12> kKinds = {{
    {"checkerboard", parse_checkerboard,
     "A right text is 'checkerboard:9x6:25mm': 9 by 6 inner corners, squares of 25 mm."},
    {"puzzle", parse_puzzle,
     "A right text is 'puzzle:14x9:20mm': a PuzzleBoard of 14 by 9 inner corners, squares of 20 "
     "mm."},
    {"charuco", parse_charuco,
     "A right text is 'charuco:5x7:40mm:20mm:DICT_6X6_250': 5 by 7 squares of 40 mm, markers of "
     "20 mm."},
    {"aprilgrid", parse_april_grid,
     "A right text is 'aprilgrid:6x6:88mm:0.3': 6 by 6 tags of 88 mm, 0.3 of that between them."},
    {"aruco", parse_aruco,
     "A right text is 'aruco:5x7:40mm:10mm:DICT_6X6_250': 5 by 7 tags of 40 mm, 10 mm from each to "
     "the next; or 'aruco:80mm:3=0,0+7=250mm,0:DICT_6X6_250': the tags 3 and 7 of 80 mm, 250 mm "
     "apart."},
    {"apriltag", parse_april_tags,
     "A right text is 'apriltag:tag36h11:5x7:40mm:10mm': 5 by 7 tags of 40 mm, 10 mm from each to "
     "the next; or 'apriltag:tag36h11:80mm:3=0,0+7=250mm,0': the tags 3 and 7 of 80 mm, 250 mm "
     "apart."},
    {"circles", parse_circles<CircleGrid>,
     "A right text is 'circles:7x5:30mm': 7 by 5 circles, 30 mm from centre to centre."},
    {"acircles", parse_circles<AsymmetricCircleGrid>,
     "A right text is 'acircles:4x11:20mm': 11 rows of 4 circles, 20 mm from row to row."},
    {"dots", parse_dots,
     "A right text is 'dots:14x10:7mm:rings=2.2+12.2+2.8': 14 by 10 dots 7 mm apart, of which "
     "those "
     "at column 2, row 2 and so on are rings; or 'dots:1mm': a grid of dots, 1 mm apart, of which "
     "any part is in view."},
    {"lines", parse_lines,
     "A right text is 'lines:1mm': a grid of lines, 1 mm apart, of which any part is in view."},
    {"dot", parse_dot, "A right text is 'dot': a light that is moved before several cameras."},
    {"wand", parse_wand,
     "A right text is 'wand:150mm+350mm': three lights on a line, 150 mm from the first to the "
     "second and 350 mm from that to the third."},
}};

const KindOfText* kind_of_text(std::string_view text) {
  const std::string_view name = split(text, ':').front();
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(),
                                 [&](const KindOfText& k) { return k.name == name; });
  return kind == kKinds.end() ? nullptr : &*kind;
}

}  // namespace

tl::unexpected<Error> wrong_board_text(std::string_view text, std::string_view why,
                                       ErrorCode code) {
  const KindOfText* kind = kind_of_text(text);
  return make_error(code, one_line(fmt::format("The board text '{}' is wrong: {}. {}",
                                               text.substr(0, kShown), without_stop(why),
                                               (kind == nullptr ? kKinds[0] : *kind).example)));
}

Result<Board> parse_board(std::string_view text) {
  if (text.size() > kLongest) return wrong_board_text(text, "it is too long");
  const auto fields = split(text, ':');
  if (fields[0].ends_with(".json")) {
    return wrong_board_text(text,
                            "a file of board names needs the name too, as in boards.json#floor");
  }
  const KindOfText* kind = kind_of_text(text);
  if (fields[0] == "auto") {
    return wrong_board_text(text,
                            "'auto' stands alone, for calibdetect, calibrate and "
                            "calvin-calibrate-images, which find out what board it is");
  }
  if (kind == nullptr) {
    return wrong_board_text(text, fmt::format("there is no kind of board called '{}'", fields[0]));
  }
  auto board = kind->parse({fields.begin() + 1, fields.end()});
  if (!board) return wrong_board_text(text, board.error().message);
  return board;
}

}  // namespace calvin
