// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The artwork, a caption with a ruler, and the marks along which a sheet is cut.

#include "calvin/draw/board/page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/draw/board/paper.hpp"
#include "calvin/target/artwork/artwork.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

namespace {

constexpr double kRoundness = 1e-6;  // m, of a drawn circle

// Everything of the caption, m.
constexpr double kBaseline = 0.0055;  // above the lower edge: what most printers can still reach
constexpr double kFontSize = 0.0032;
constexpr double kSmallestFont = 0.0022;
constexpr double kCaptionWidth = 0.180;  // if the pattern is narrower and the page is not
constexpr double kCaptionBorder = 0.005;
constexpr double kRulerShare = 0.56;  // of the caption's width, at most
constexpr double kGap = 0.003;
constexpr double kTick = 0.0015;
constexpr double kLine = 0.0002;
constexpr double kBleed = 0.0015;   // that is drawn beyond a cut, so that none shows white
constexpr double kMarkGap = 0.002;  // from a cut to its mark
constexpr double kMarkLength = 0.004;

// Dark cells side by side in a row.
struct Run {
  int first = 0;
  int end = 0;  // the column after the last
  int row = 0;  // the first of all rows that have it
};

std::vector<Run> runs_of(const Artwork& artwork, int row) {
  std::vector<Run> runs;
  for (int col = 0; col < artwork.cols(); ++col) {
    if (!artwork.is_dark(col, row)) continue;
    if (runs.empty() || runs.back().end != col) runs.push_back({col, col, row});
    ++runs.back().end;
  }
  return runs;
}

// Runs that are the same in row after row are drawn as one: cells that only touch may show a gap.
void draw_cells(cairo_t* cr, const Artwork& artwork) {
  std::vector<Run> open;
  for (int row = 0; row <= artwork.rows(); ++row) {
    auto runs = row < artwork.rows() ? runs_of(artwork, row) : std::vector<Run>();
    for (const Run& above : open) {
      const auto same = std::find_if(runs.begin(), runs.end(), [&](const Run& run) {
        return run.first == above.first && run.end == above.end;
      });
      if (same != runs.end()) {
        same->row = above.row;
        continue;
      }
      const auto x = [&](int col) { return artwork.x[static_cast<std::size_t>(col)]; };
      const auto y = [&](int cut) { return artwork.y[static_cast<std::size_t>(cut)]; };
      cairo_rectangle(cr, x(above.first), y(above.row), x(above.end) - x(above.first),
                      y(row) - y(above.row));
    }
    open = std::move(runs);
  }
  cairo_fill(cr);
}

void draw_artwork(cairo_t* cr, const Artwork& artwork, const Canvas& canvas) {
  canvas.take_ink(cr, true);
  draw_cells(cr, artwork);
  cairo_set_tolerance(cr, kRoundness * canvas.units_per_metre);
  for (std::size_t i = 0; i < artwork.discs.size(); ++i) {
    const Artwork::Disc& disc = artwork.discs[i];
    cairo_new_sub_path(cr);
    cairo_arc(cr, disc.x, disc.y, disc.diameter / 2, 0, 2 * std::numbers::pi);
    // Those of one colour that follow each other are one path.
    if (i + 1 < artwork.discs.size() && artwork.discs[i + 1].is_dark == disc.is_dark) continue;
    canvas.take_ink(cr, disc.is_dark);
    cairo_fill(cr);
  }
}

// All sheets of a board, which lie in the plane of the page.
void draw_sheets(cairo_t* cr, const Board& board, const Canvas& canvas) {
  for (const auto& [board_from_sheet, artwork] : artworks_of(board)) {
    cairo_save(cr);
    cairo_translate(cr, board_from_sheet.translation.x(), board_from_sheet.translation.y());
    cairo_rotate(cr, std::atan2(board_from_sheet.rotation(1, 0), board_from_sheet.rotation(0, 0)));
    draw_artwork(cr, artwork, canvas);
    cairo_restore(cr);
  }
}

double text_width(cairo_t* cr, const std::string& text, double size) {
  cairo_text_extents_t extents;
  cairo_set_font_size(cr, size);
  cairo_text_extents(cr, text.c_str(), &extents);
  return extents.x_advance;
}

void draw_ruler(cairo_t* cr, double x, double y, double length) {
  const double step = length >= 0.05 ? 0.01 : 0.005;
  const int steps = static_cast<int>(std::lround(length / step));
  cairo_set_line_width(cr, kLine);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
  for (int i = 0; i <= steps; ++i) {
    const bool end = i == 0 || i == steps;
    cairo_move_to(cr, x + i * step, y);
    cairo_line_to(cr, x + i * step, y - (end ? 1.6 : 1) * kTick);
  }
  cairo_move_to(cr, x - kLine / 2, y);
  cairo_line_to(cr, x + length + kLine / 2, y);
  cairo_stroke(cr);
}

// A line of text and a ruler at the foot of a page, `width` m wide where the page is. The first
// text that is not too small there is taken.
void draw_foot(cairo_t* cr, const BoardLayout& page, double width,
               const std::vector<std::string>& texts, double ruler) {
  const double left = (page.width - width) / 2;
  const double y = page.height - kBaseline;
  const double room = width - ruler - kGap;
  double font = 0;
  const std::string* text = nullptr;
  for (const std::string& one : texts) {
    text = &one;
    font = std::min(kFontSize, kFontSize * room / text_width(cr, one, kFontSize));
    if (font >= kSmallestFont) break;
  }
  cairo_set_font_size(cr, font);
  cairo_move_to(cr, left, y);
  cairo_show_text(cr, text->c_str());
  draw_ruler(cr, left + width - ruler, y, ruler);
}

double ruler_for(double width) {
  constexpr std::array<double, 4> kRulers = {0.1, 0.05, 0.02, 0.01};
  return *std::find_if(kRulers.begin(), kRulers.end() - 1,
                       [width](double length) { return length <= kRulerShare * width; });
}

void draw_caption(cairo_t* cr, const Board& board, const BoardLayout& page) {
  const double width =
      std::max(board.outline().width(), std::min(page.width - 2 * kCaptionBorder, kCaptionWidth));
  const double ruler = ruler_for(width);
  const std::string size = fmt::format("{} mm", std::lround(ruler * 1e3));
  draw_foot(cr, page, width,
            {fmt::format("{}   Print at 100 %: the ruler is {} long.", board.text(), size),
             fmt::format("{}   {}", board.text(), size)},
            ruler);
}

void draw_tile_caption(cairo_t* cr, const Board& board, const BoardTile& tile) {
  constexpr double kShare = 0.3;  // of the width, for the ruler: there is more to say
  const double width = tile.page.width - 2 * kTileMargin;
  const double ruler = ruler_for(kShare / kRulerShare * width);
  const std::string size = fmt::format("{} mm", std::lround(ruler * 1e3));
  const std::string place =
      fmt::format("sheet {} of {}: column {} of {}, row {} of {}",
                  Grid{tile.cols, tile.rows}.id({tile.col, tile.row}) + 1, tile.cols * tile.rows,
                  tile.col + 1, tile.cols, tile.row + 1, tile.rows);
  draw_foot(cr, tile.page, width,
            {fmt::format("{}   {}. Print at 100 %: the ruler is {} long. Cut at the marks.",
                         board.text(), place, size),
             fmt::format("{}   {}   {}", board.text(), place, size), place},
            ruler);
}

// Two short lines outside of each corner of the part that is cut out.
void draw_cut_marks(cairo_t* cr, const BoardTile& tile) {
  cairo_set_line_width(cr, kLine);
  for (const auto& [x, way_x] : {std::pair{tile.left, -1.0}, {tile.right, 1.0}}) {
    for (const auto& [y, way_y] : {std::pair{tile.top, -1.0}, {tile.bottom, 1.0}}) {
      cairo_move_to(cr, x + way_x * kMarkGap, y);
      cairo_rel_line_to(cr, way_x * kMarkLength, 0);
      cairo_move_to(cr, x, y + way_y * kMarkGap);
      cairo_rel_line_to(cr, 0, way_y * kMarkLength);
    }
  }
  cairo_stroke(cr);
}

// White paper whose unit is one metre.
void begin_page(cairo_t* cr, const Canvas& canvas) {
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_paint(cr);
  cairo_scale(cr, canvas.units_per_metre, canvas.units_per_metre);
  canvas.take_ink(cr, true);
  const CairoFontOptions hints(cairo_font_options_create());
  cairo_font_options_set_hint_style(hints.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(hints.get(), CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(hints.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(cr, hints.get());
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
}

}  // namespace

void paint_page(const Canvas& canvas, const Board& board, const BoardLayout& page) {
  const CairoContext context(cairo_create(canvas.surface.get()));
  cairo_t* cr = context.get();
  begin_page(cr, canvas);
  cairo_save(cr);
  cairo_translate(cr, page.x, page.y);
  draw_sheets(cr, board, canvas);
  cairo_restore(cr);
  draw_caption(cr, board, page);
  cairo_show_page(cr);
}

void paint_tile(const Canvas& canvas, const Board& board, const BoardTile& tile) {
  const CairoContext context(cairo_create(canvas.surface.get()));
  cairo_t* cr = context.get();
  begin_page(cr, canvas);
  cairo_save(cr);
  cairo_rectangle(cr, tile.left - kBleed, tile.top - kBleed, tile.right - tile.left + 2 * kBleed,
                  tile.bottom - tile.top + 2 * kBleed);
  cairo_clip(cr);
  cairo_translate(cr, tile.page.x, tile.page.y);
  draw_sheets(cr, board, canvas);
  cairo_restore(cr);
  draw_cut_marks(cr, tile);
  draw_tile_caption(cr, board, tile);
  cairo_show_page(cr);
}

}  // namespace calvin
