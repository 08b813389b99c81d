// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells a file of points from a board, and takes the pixels that come with its rows.

#include "calvin/session/points/known_points.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/point_rows.hpp"
#include "calvin/target/unbounded_grid.hpp"

namespace calvin {

namespace {

constexpr std::string_view kPoints = "points:";
constexpr std::size_t kMostSeen = 2000;

tl::unexpected<Error> wrong(std::string_view text, const Error& why) {
  return make_error(why.code, fmt::format("The points '{}' cannot be used: {}",
                                          shortened(text, 200), why.message));
}

// A board of the kinds that a text tells has a ':' behind its kind, and a file of names a '#'.
bool is_board(std::string_view text) {
  return !text.starts_with(kPoints) && text.find_first_of(":#") != std::string_view::npos;
}

Result<KnownPoints> of_board(std::string_view text) {
  auto boards = parse_boards(text);
  if (!boards) return wrong(text, boards.error());
  if (boards->size() != 1) {
    return wrong(text, {ErrorCode::kInvalidArgument, "they are of several boards: name one."});
  }
  const Board& board = boards->front();
  for (const Status& fits : {check_has_pose(board), check_names_points(board)}) {
    if (!fits) return wrong(text, fits.error());
  }
  return KnownPoints{board, {}, false};
}

Result<KnownPoints> of_file(std::string_view text) {
  const std::string path(text.starts_with(kPoints) ? trim(text.substr(kPoints.size())) : text);
  const auto rows = read_point_rows(path);
  if (!rows) return wrong(text, rows.error());
  auto board = board_of_rows(*rows, path);
  if (!board) return wrong(text, board.error());
  KnownPoints known{*std::move(board), {}, true};
  for (const PointRow& row : *rows) {
    if (row.seen) known.seen.push_back({*row.seen, row.point, row.sigma.value_or(kClickSigma)});
  }
  if (known.seen.size() > kMostSeen) {
    return wrong(text,
                 {ErrorCode::kInvalidArgument,
                  fmt::format("it has {} pixels, and at most {} are taken: solve so many with "
                              "calvin-solve.",
                              known.seen.size(), kMostSeen)});
  }
  return known;
}

}  // namespace

Result<KnownPoints> read_known_points(std::string_view text) {
  text = trim(text);
  return is_board(text) ? of_board(text) : of_file(text);
}

std::string points_text(const std::string& points, const std::string& board) {
  if (!trim(points).empty()) return points;
  const std::string_view text = trim(board);
  const bool is_file = text.starts_with(kPoints) && text.find(';') == std::string_view::npos;
  return is_file ? board : "";
}

}  // namespace calvin
