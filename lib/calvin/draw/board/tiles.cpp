// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cuts a board between its control points, so that each part fits on a sheet.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/draw/board/layout.hpp"
#include "calvin/draw/board/paper.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr std::size_t kMostTiles = 200;

// A sheet as it lies.
struct Sheet {
  double width = 0;
  double height = 0;
};

// Places half way between control points along one axis, where it is far from one to the next,
// ascending.
std::vector<double> clear_places(std::vector<double> at) {
  constexpr double kFar = 0.5;  // of the largest gap
  std::ranges::sort(at);
  double largest = 0;
  for (std::size_t i = 1; i < at.size(); ++i) largest = std::max(largest, at[i] - at[i - 1]);
  std::vector<double> places;
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] - at[i - 1] >= kFar * largest) places.push_back((at[i] + at[i - 1]) / 2);
  }
  return places;
}

// The ends of all parts of a length, each at most `most` long, with as few parts as may be.
std::vector<double> cuts_of(double from, double to, double most,
                            const std::vector<double>& places) {
  constexpr double kShortest = 0.5;  // of a part that could be longer
  std::vector<double> cuts = {from};
  while (to - cuts.back() > most + kLengthSlack) {
    const double last = cuts.back() + most;
    const auto after = std::ranges::upper_bound(places, last);
    const bool is_clear = after != places.begin() && *(after - 1) > cuts.back() + kShortest * most;
    cuts.push_back(is_clear ? *(after - 1) : last);
  }
  cuts.push_back(to);
  return cuts;
}

// Along one axis of the board frame.
template <typename Coordinate>
std::vector<double> cuts_along(const Board& board, double from, double to, double most,
                               Coordinate coordinate) {
  std::vector<double> at;
  for (const Eigen::Vector3d& p : board.points()) at.push_back(coordinate(p));
  return cuts_of(from, to, most, clear_places(std::move(at)));
}

// The parts on sheets that lie one way.
struct Parts {
  Sheet sheet;
  std::vector<double> x;
  std::vector<double> y;
  [[nodiscard]] std::size_t count() const { return (x.size() - 1) * (y.size() - 1); }
};

Parts parts_on(const Board& board, const Sheet& sheet) {
  const double border = white_border(board);
  const BoardArea area = board.outline();
  Parts parts{sheet, {}, {}};
  parts.x = cuts_along(board, area.left - border, area.right + border,
                       sheet.width - 2 * kTileMargin, [](const auto& p) { return p.x(); });
  parts.y = cuts_along(board, area.top - border, area.bottom + border,
                       sheet.height - 2 * kTileMargin - kCaptionHeight,
                       [](const auto& p) { return p.y(); });
  return parts;
}

// Whether there would be too many parts to count them one by one.
bool is_far_too_large(const Board& board, const Sheet& sheet) {
  const BoardArea area = board.outline();
  return area.width() > static_cast<double>(kMostTiles) * sheet.width ||
         area.height() > static_cast<double>(kMostTiles) * sheet.height;
}

std::vector<BoardTile> tiles_of(const Parts& parts) {
  std::vector<BoardTile> tiles;
  for (std::size_t row = 0; row + 1 < parts.y.size(); ++row) {
    for (std::size_t col = 0; col + 1 < parts.x.size(); ++col) {
      const double width = parts.x[col + 1] - parts.x[col];
      const double height = parts.y[row + 1] - parts.y[row];
      BoardTile tile;
      tile.left = (parts.sheet.width - width) / 2;
      tile.top = kTileMargin;
      tile.right = tile.left + width;
      tile.bottom = tile.top + height;
      tile.page = {parts.sheet.width, parts.sheet.height, tile.left - parts.x[col],
                   tile.top - parts.y[row]};
      tile.col = static_cast<int>(col);
      tile.row = static_cast<int>(row);
      tile.cols = static_cast<int>(parts.x.size()) - 1;
      tile.rows = static_cast<int>(parts.y.size()) - 1;
      tiles.push_back(tile);
    }
  }
  return tiles;
}

std::optional<Paper> paper_of(std::string_view name) {
  const std::string known = lower(name);
  const auto paper = std::ranges::find(papers(), known == "auto" ? "a4" : known, &Paper::name);
  if (paper == papers().end()) return std::nullopt;
  return *paper;
}

}  // namespace

Result<std::vector<BoardTile>> lay_out_tiles(const Board& board, std::string_view paper) {
  if (const Status checked = board.check(); !checked) {
    return tl::unexpected<Error>(checked.error());
  }
  if (const Status printable = check_printable(board); !printable) {
    return tl::unexpected<Error>(printable.error());
  }
  const auto known = paper_of(paper);
  if (!known) return no_such_paper(paper, "");
  std::optional<Parts> best;
  for (const Sheet& sheet :
       {Sheet{known->width, known->height}, Sheet{known->height, known->width}}) {
    if (is_far_too_large(board, sheet)) continue;
    Parts parts = parts_on(board, sheet);
    if (!best || parts.count() < best->count()) best = std::move(parts);
  }
  if (!best || best->count() > kMostTiles) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("{} needs more than {} sheets of {}: take a larger paper, or "
                                  "smaller squares.",
                                  board.text(), kMostTiles, known->name));
  }
  return tiles_of(*best);
}

}  // namespace calvin
