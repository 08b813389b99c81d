// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws a board with Cairo as SVG, PDF or PNG, with a ruler that shows whether the printer kept the
// scale.

#include "calvin/draw/board_drawing.hpp"

#include "calvin_config.h"

#if CALVIN_HAVE_CAIRO

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/draw/cairo.hpp"
#include "calvin/draw/page.hpp"
#include "calvin/draw/png.hpp"
#include "calvin/target/artwork/artwork.hpp"

namespace calvin {

namespace {

constexpr double kInch = 0.0254;  // m
constexpr double kPoint = 0.0254 / 72;
constexpr double kMostPixels = 2e8;     // of a PNG: as many bytes while drawing
constexpr double kLongestSide = 32767;  // px, Cairo's own limit
constexpr double kRoundness = 1e-6;     // m, of a drawn circle

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

// Exceptions must not pass through Cairo's C.
cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) noexcept {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  } catch (const std::exception&) {
    return CAIRO_STATUS_WRITE_ERROR;
  }
}

// A page to draw on, its user unit one metre.
struct Canvas {
  CairoSurface surface;
  double units_per_metre = 1;
  // A PNG is drawn on an alpha-only surface, which Cairo writes as 8-bit grey: a quarter of the
  // memory, and opaque means white.
  bool is_alpha_only = false;

  void take_ink(cairo_t* cr, bool is_dark) const {
    const double level = is_dark ? 0 : 1;
    cairo_set_source_rgb(cr, level, level, level);
    cairo_set_operator(cr,
                       is_alpha_only && is_dark ? CAIRO_OPERATOR_DEST_OUT : CAIRO_OPERATOR_OVER);
  }
};

Canvas canvas_for(const BoardLayout& page, const DrawingOptions& options, std::string* bytes) {
  Canvas canvas;
  if (options.format == DrawingFormat::kPng) {
    canvas.units_per_metre = options.dpi / kInch;
    canvas.is_alpha_only = true;
    canvas.surface.reset(cairo_image_surface_create(
        CAIRO_FORMAT_A8, static_cast<int>(std::ceil(page.width * canvas.units_per_metre - 1e-6)),
        static_cast<int>(std::ceil(page.height * canvas.units_per_metre - 1e-6))));
  } else if (options.format == DrawingFormat::kPdf) {
    canvas.units_per_metre = 1 / kPoint;
    canvas.surface.reset(cairo_pdf_surface_create_for_stream(append, bytes, page.width / kPoint,
                                                             page.height / kPoint));
  } else {
    canvas.units_per_metre = 1000;
    canvas.surface.reset(
        cairo_svg_surface_create_for_stream(append, bytes, page.width * 1000, page.height * 1000));
    cairo_svg_surface_set_document_unit(canvas.surface.get(), CAIRO_SVG_UNIT_MM);
  }
  return canvas;
}

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

void draw_caption(cairo_t* cr, const Board& board, const BoardLayout& page) {
  constexpr std::array<double, 4> kRulers = {0.1, 0.05, 0.02, 0.01};
  const double width =
      std::max(board.outline().width(), std::min(page.width - 2 * kCaptionBorder, kCaptionWidth));
  const double left = (page.width - width) / 2;
  const double y = page.height - kBaseline;
  const double ruler = *std::find_if(kRulers.begin(), kRulers.end() - 1, [width](double length) {
    return length <= kRulerShare * width;
  });
  const double room = width - ruler - kGap;

  const std::string size = fmt::format("{} mm", std::lround(ruler * 1e3));
  std::string text = fmt::format("{}   Print at 100 %: the ruler is {} long.", board.text(), size);
  double font = std::min(kFontSize, kFontSize * room / text_width(cr, text, kFontSize));
  if (font < kSmallestFont) {
    text = fmt::format("{}   {}", board.text(), size);
    font = std::min(kFontSize, kFontSize * room / text_width(cr, text, kFontSize));
  }
  cairo_set_font_size(cr, font);
  cairo_move_to(cr, left, y);
  cairo_show_text(cr, text.c_str());
  draw_ruler(cr, left + width - ruler, y, ruler);
}

void draw_page(const Canvas& canvas, const Board& board, const BoardLayout& page) {
  const CairoContext context(cairo_create(canvas.surface.get()));
  cairo_t* cr = context.get();
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_paint(cr);
  cairo_scale(cr, canvas.units_per_metre, canvas.units_per_metre);
  canvas.take_ink(cr, true);
  cairo_save(cr);
  cairo_translate(cr, page.x, page.y);
  draw_sheets(cr, board, canvas);
  cairo_restore(cr);

  const CairoFontOptions hints(cairo_font_options_create());
  cairo_font_options_set_hint_style(hints.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(hints.get(), CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(hints.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(cr, hints.get());
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  draw_caption(cr, board, page);
  cairo_show_page(cr);
}

Status check_pixels(const BoardLayout& page, double dpi) {
  if (!(dpi >= 20 && dpi <= 2400)) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("{} dpi is out of range (20 to 2400).", dpi));
  }
  const double most = std::min(std::sqrt(kMostPixels / (page.width * page.height)),
                               kLongestSide / std::max(page.width, page.height)) *
                      kInch;
  if (dpi <= most) return {};
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("At {} dpi the page would have too many pixels; take at most {:.0f} dpi, "
                  "or PDF or SVG, which have none.",
                  dpi, std::floor(most)));
}

Result<std::string> draw(const Board& board, const DrawingOptions& options) {
  const auto page = lay_out_board(board, options.paper);
  if (!page) return tl::unexpected<Error>(page.error());
  const bool png = options.format == DrawingFormat::kPng;
  if (png) {
    if (const Status fits = check_pixels(*page, options.dpi); !fits) {
      return tl::unexpected<Error>(fits.error());
    }
  }
  std::string bytes;
  const Canvas canvas = canvas_for(*page, options, &bytes);
  cairo_surface_t* surface = canvas.surface.get();
  if (options.format == DrawingFormat::kPdf) {
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, board.text().c_str());
  }
  draw_page(canvas, board, *page);
  cairo_status_t status = cairo_surface_status(surface);
  if (png && status == CAIRO_STATUS_SUCCESS) {
    status = cairo_surface_write_to_png_stream(surface, append, &bytes);
  }
  cairo_surface_finish(surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
  if (status != CAIRO_STATUS_SUCCESS) {
    return make_error(ErrorCode::kIo, fmt::format("Cairo cannot draw the board {}: {}.",
                                                  board.text(), cairo_status_to_string(status)));
  }
  if (png) set_png_resolution(bytes, options.dpi / kInch);
  return bytes;
}

}  // namespace

Result<std::string> draw_board(const Board& board, const DrawingOptions& options) {
  try {
    return draw(board, options);
  } catch (const std::exception& error) {
    return make_error(ErrorCode::kIo, fmt::format("The board cannot be drawn: {}.", error.what()));
  }
}

}  // namespace calvin

#else

namespace calvin {

Result<std::string> draw_board(const Board& /*board*/, const DrawingOptions& /*options*/) {
  return make_error(
      ErrorCode::kUnsupported,
      "This build draws no boards: it was made without Cairo. Build it with -Ddraw=enabled.");
}

}  // namespace calvin

#endif
