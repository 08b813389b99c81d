// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Paints a page with a board, or a part of one, and what stands below it. Internal.
#pragma once

#include <string>

#include "calvin/draw/board/layout.hpp"
#include "calvin/draw/cairo.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

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

void paint_page(const Canvas& canvas, const Board& board, const BoardLayout& page);

// With marks where the sheet is to be cut, and which of all sheets it is.
void paint_tile(const Canvas& canvas, const Board& board, const BoardTile& tile);

}  // namespace calvin
