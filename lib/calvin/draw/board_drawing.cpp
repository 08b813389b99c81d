// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws a board with Cairo as SVG, PDF or PNG, with a ruler that shows whether the printer kept the
// scale.

#include "calvin/draw/board_drawing.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "calvin/draw/board/paper.hpp"
#include "calvin_config.h"

#if CALVIN_HAVE_CAIRO

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <vector>

#include "calvin/draw/board/page.hpp"
#include "calvin/draw/cairo.hpp"
#include "calvin/draw/png.hpp"

namespace calvin {

namespace {

constexpr double kInch = 0.0254;  // m
constexpr double kPoint = 0.0254 / 72;
constexpr double kMostPixels = 2e8;     // of a PNG: as many bytes while drawing
constexpr double kLongestSide = 32767;  // px, Cairo's own limit

// Exceptions must not pass through Cairo's C.
cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) noexcept {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  } catch (const std::exception&) {
    return CAIRO_STATUS_WRITE_ERROR;
  }
}

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

tl::unexpected<Error> cairo_failed(const Board& board, cairo_status_t status) {
  return make_error(ErrorCode::kIo, fmt::format("Cairo cannot draw the board {}: {}.", board.text(),
                                                cairo_status_to_string(status)));
}

// A file of one or more pages of one size; `paint` takes the canvas.
template <typename Paint>
Result<std::string> draw_pages(const Board& board, const BoardLayout& page,
                               const DrawingOptions& options, Paint paint) {
  const bool png = options.format == DrawingFormat::kPng;
  if (png) {
    if (const Status fits = check_pixels(page, options.dpi); !fits) {
      return tl::unexpected<Error>(fits.error());
    }
  }
  std::string bytes;
  const Canvas canvas = canvas_for(page, options, &bytes);
  cairo_surface_t* surface = canvas.surface.get();
  if (options.format == DrawingFormat::kPdf) {
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, board.text().c_str());
  }
  paint(canvas);
  cairo_status_t status = cairo_surface_status(surface);
  if (png && status == CAIRO_STATUS_SUCCESS) {
    status = cairo_surface_write_to_png_stream(surface, append, &bytes);
  }
  cairo_surface_finish(surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
  if (status != CAIRO_STATUS_SUCCESS) return cairo_failed(board, status);
  if (png) set_png_resolution(bytes, options.dpi / kInch);
  return bytes;
}

Result<std::string> draw(const Board& board, const DrawingOptions& options) {
  const auto page = lay_out_board(board, options.paper);
  if (!page) return tl::unexpected<Error>(page.error());
  return draw_pages(board, *page, options,
                    [&](const Canvas& canvas) { paint_page(canvas, board, *page); });
}

Result<std::vector<std::string>> draw_on_tiles(const Board& board, const DrawingOptions& options) {
  const auto tiles = lay_out_tiles(board, options.paper);
  if (!tiles) return tl::unexpected<Error>(tiles.error());
  std::vector<std::string> files;
  const std::size_t pages = options.format == DrawingFormat::kPdf ? tiles->size() : 1;
  for (std::size_t first = 0; first < tiles->size(); first += pages) {
    auto file = draw_pages(board, tiles->front().page, options, [&](const Canvas& canvas) {
      for (std::size_t i = first; i < first + pages; ++i) paint_tile(canvas, board, (*tiles)[i]);
    });
    if (!file) return tl::unexpected<Error>(file.error());
    files.push_back(*std::move(file));
  }
  return files;
}

}  // namespace

Result<std::string> draw_board(const Board& board, const DrawingOptions& options) {
  try {
    return draw(board, options);
  } catch (const std::exception& error) {
    return make_error(ErrorCode::kIo, fmt::format("The board cannot be drawn: {}.", error.what()));
  }
}

Result<std::vector<std::string>> draw_tiles(const Board& board, const DrawingOptions& options) {
  try {
    return draw_on_tiles(board, options);
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

Result<std::vector<std::string>> draw_tiles(const Board& board, const DrawingOptions& options) {
  return tl::unexpected<Error>(draw_board(board, options).error());
}

}  // namespace calvin

#endif

namespace calvin {

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
