// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which paper a board fits on, and where.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/draw/board/layout.hpp"
#include "calvin/draw/board/paper.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr double kNarrowestPage = 0.08;  // m, so that the caption has room
constexpr double kLargestPage = 5;       // m, the PDF format's own limit is 200 inches

struct PageSize {
  double width = 0;
  double height = 0;
};

PageSize pattern_of(const Board& board) {
  const BoardArea outline = board.outline();
  return {outline.width(), outline.height()};
}

PageSize page_for(const Board& board) {
  const double border = 2 * white_border(board);
  const PageSize pattern = pattern_of(board);
  return {pattern.width + border, pattern.height + border + kCaptionHeight};
}

bool holds(const PageSize& page, const PageSize& needed) {
  return page.width + kLengthSlack >= needed.width && page.height + kLengthSlack >= needed.height;
}

// The paper as the board lies on it, along the board's longer side if both ways fit.
std::optional<PageSize> turned_for(const Board& board, const Paper& paper) {
  const PageSize upright{paper.width, paper.height};
  const PageSize lying{paper.height, paper.width};
  const PageSize needed = page_for(board);
  const bool wide = pattern_of(board).width > pattern_of(board).height;
  if (holds(wide ? lying : upright, needed)) return wide ? lying : upright;
  if (holds(wide ? upright : lying, needed)) return wide ? upright : lying;
  return std::nullopt;
}

// What lies on a page grows with the cells, but for a border that is at least so wide and the
// caption.
double largest_cell_upright(const PageSize& cells, double width, double height) {
  const auto along = [](double count, double length) {
    return std::min(length / (count + 1), (length - 2 * kSmallestBorder) / count);
  };
  return std::min(along(cells.width, width), along(cells.height, height - kCaptionHeight));
}

double largest_cell(const Board& board, const Paper& paper) {
  const double own = board.cell_size(board.ids().front());
  const PageSize cells{pattern_of(board).width / own, pattern_of(board).height / own};
  const double size = std::max(largest_cell_upright(cells, paper.width, paper.height),
                               largest_cell_upright(cells, paper.height, paper.width));
  return std::floor(size * 1e4 + 1e-6) / 1e4;  // down to 0.1 mm
}

// The same board with cells of another size; absent for one whose measures are no multiples of one.
std::optional<Board> with_cells_of(const Board& board, double size) {
  return std::visit(
      [size](const auto& kind) -> std::optional<Board> {
        if constexpr (requires { kind.with_cells_of(size); }) return kind.with_cells_of(size);
        return std::nullopt;
      },
      board.kind());
}

std::string in_mm(const PageSize& extent) {
  return fmt::format("{:.0f} x {:.0f} mm", std::ceil(extent.width * 1e3 - 1e-6),
                     std::ceil(extent.height * 1e3 - 1e-6));
}

tl::unexpected<Error> does_not_fit(const Board& board, const Paper& paper) {
  const auto better = std::find_if(papers().begin(), papers().end(), [&](const Paper& p) {
    return p.automatic && turned_for(board, p).has_value();
  });
  std::string advice = fmt::format(
      "paper '{}' holds it", better == papers().end() ? std::string_view("fit") : better->name);
  const double size = largest_cell(board, paper);
  const auto smaller = size > 0 ? with_cells_of(board, size) : std::nullopt;
  if (smaller) {
    advice += fmt::format(", or squares of at most {}mm do ({})", std::round(size * 1e4) / 10,
                          smaller->text());
  }
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("{} needs {} with its white border and does not fit on {} ({}): {}.",
                  board.text(), in_mm(page_for(board)), paper.name,
                  in_mm({paper.width, paper.height}), advice));
}

BoardLayout centred(const Board& board, const PageSize& page) {
  const PageSize pattern = pattern_of(board);
  const BoardArea outline = board.outline();
  return {page.width, page.height, (page.width - pattern.width) / 2 - outline.left,
          (page.height - kCaptionHeight - pattern.height) / 2 - outline.top};
}

Result<BoardLayout> made_to_measure(const Board& board) {
  PageSize page = page_for(board);
  page.width = std::max(page.width, kNarrowestPage);
  if (std::max(page.width, page.height) > kLargestPage) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("{} needs a page of {}, more than the {} m that a drawing may have; "
                    "take smaller squares.",
                    board.text(), in_mm(page), kLargestPage));
  }
  return centred(board, page);
}

}  // namespace

Result<BoardLayout> lay_out_board(const Board& board, std::string_view paper) {
  if (const Status checked = board.check(); !checked) return tl::unexpected(checked.error());
  if (const Status printable = check_printable(board); !printable) {
    return tl::unexpected<Error>(printable.error());
  }
  const std::string name = lower(paper);
  if (name == "fit") return made_to_measure(board);
  for (const Paper& candidate : papers()) {
    if (name != candidate.name && !(name == "auto" && candidate.automatic)) continue;
    if (const auto page = turned_for(board, candidate)) return centred(board, *page);
    if (name != "auto") return does_not_fit(board, candidate);
  }
  if (name == "auto") return made_to_measure(board);
  return no_such_paper(paper, "auto, fit or ");
}

}  // namespace calvin
