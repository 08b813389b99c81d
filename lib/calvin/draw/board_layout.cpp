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
#include "calvin/draw/board_drawing.hpp"
#include "calvin/draw/page.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

struct Paper {
  std::string_view name;
  double width;  // m, upright
  double height;
  bool automatic;  // one of those that "auto" takes
};

constexpr std::array<Paper, 8> kPapers = {{
    {"letter", 0.2159, 0.2794, false},
    {"a4", 0.210, 0.297, true},
    {"legal", 0.2159, 0.3556, false},
    {"tabloid", 0.2794, 0.4318, false},
    {"a3", 0.297, 0.420, true},
    {"a2", 0.420, 0.594, true},
    {"a1", 0.594, 0.841, true},
    {"a0", 0.841, 1.189, true},
}};

// ASCII only and whatever the locale.
std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

constexpr double kSmallestBorder = 0.005;  // m
constexpr double kNarrowestPage = 0.08;    // m, so that the caption has room
constexpr double kLargestPage = 5;         // m, the PDF format's own limit is 200 inches
constexpr double kSlack = 1e-9;            // m, for 275 mm that come out as 275.0000001 mm

struct Extent {
  double width = 0;
  double height = 0;
};

Extent pattern_of(const Board& board) {
  const BoardArea outline = board.outline();
  return {outline.width(), outline.height()};
}

Extent page_for(const Board& board) {
  const double border = 2 * std::max(board.cell_size(board.ids().front()) / 2, kSmallestBorder);
  const Extent pattern = pattern_of(board);
  return {pattern.width + border, pattern.height + border + kCaptionHeight};
}

bool holds(const Extent& page, const Extent& needed) {
  return page.width + kSlack >= needed.width && page.height + kSlack >= needed.height;
}

// The paper as the board lies on it, along the board's longer side if both ways fit.
std::optional<Extent> turned_for(const Board& board, const Paper& paper) {
  const Extent upright{paper.width, paper.height};
  const Extent lying{paper.height, paper.width};
  const Extent needed = page_for(board);
  const bool wide = pattern_of(board).width > pattern_of(board).height;
  if (holds(wide ? lying : upright, needed)) return wide ? lying : upright;
  if (holds(wide ? upright : lying, needed)) return wide ? upright : lying;
  return std::nullopt;
}

// What lies on a page grows with the cells, but for a border that is at least so wide and the
// caption.
double largest_cell_upright(const Extent& cells, double width, double height) {
  const auto along = [](double count, double length) {
    return std::min(length / (count + 1), (length - 2 * kSmallestBorder) / count);
  };
  return std::min(along(cells.width, width), along(cells.height, height - kCaptionHeight));
}

double largest_cell(const Board& board, const Paper& paper) {
  const double own = board.cell_size(board.ids().front());
  const Extent cells{pattern_of(board).width / own, pattern_of(board).height / own};
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

std::string in_mm(const Extent& extent) {
  return fmt::format("{:.0f} x {:.0f} mm", std::ceil(extent.width * 1e3 - 1e-6),
                     std::ceil(extent.height * 1e3 - 1e-6));
}

tl::unexpected<Error> does_not_fit(const Board& board, const Paper& paper) {
  const auto better = std::find_if(kPapers.begin(), kPapers.end(), [&](const Paper& p) {
    return p.automatic && turned_for(board, p).has_value();
  });
  std::string advice = fmt::format(
      "paper '{}' holds it", better == kPapers.end() ? std::string_view("fit") : better->name);
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

BoardLayout centred(const Board& board, const Extent& page) {
  const Extent pattern = pattern_of(board);
  const BoardArea outline = board.outline();
  return {page.width, page.height, (page.width - pattern.width) / 2 - outline.left,
          (page.height - kCaptionHeight - pattern.height) / 2 - outline.top};
}

Result<BoardLayout> made_to_measure(const Board& board) {
  Extent page = page_for(board);
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
  if (board.as<PointLight>() != nullptr) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The board {} is a light: there is nothing to print. Move an LED "
                                  "or the spot of a laser pointer before the cameras.",
                                  board.text()));
  }
  const auto* list = board.as<TagList>();
  if (list != nullptr && !list->is_flat()) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The tags of this board lie in space, not on a sheet. Draw each by itself, "
                      "such as apriltag:tag36h11:80mm:3=0,0.");
  }
  const std::string name = lower(paper);
  if (name == "fit") return made_to_measure(board);
  for (const Paper& candidate : kPapers) {
    if (name != candidate.name && !(name == "auto" && candidate.automatic)) continue;
    if (const auto page = turned_for(board, candidate)) return centred(board, *page);
    if (name != "auto") return does_not_fit(board, candidate);
  }
  if (name == "auto") return made_to_measure(board);
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("There is no paper called '{}'; use auto, fit or one of {}.", paper,
                                join(paper_names(), ", ")));
}

std::vector<std::string> paper_names() {
  std::vector<std::string> names;
  for (const Paper& paper : kPapers) names.emplace_back(paper.name);
  return names;
}

Result<DrawingFormat> drawing_format(std::string_view path) {
  constexpr std::array<std::pair<std::string_view, DrawingFormat>, 3> kFormats = {
      {{".svg", DrawingFormat::kSvg},
       {".pdf", DrawingFormat::kPdf},
       {".png", DrawingFormat::kPng}}};
  const std::string name = lower(path);
  for (const auto& [extension, format] : kFormats) {
    if (name.size() > extension.size() && name.ends_with(extension)) return format;
  }
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("'{}' tells no format: a drawing's name ends in .pdf, .svg or .png.", path));
}

}  // namespace calvin
