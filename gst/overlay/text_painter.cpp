// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pango, set up once.

#include "calvin_config.h"

#if CALVIN_HAVE_PANGO

#include "overlay/text_painter.hpp"

namespace calvin::gst {

TextPainter::TextPainter()
    : fonts_(pango_cairo_font_map_new()),
      context_(pango_font_map_create_context(fonts_)),
      layout_(pango_layout_new(context_)) {
  pango_layout_set_single_paragraph_mode(layout_, TRUE);
  pango_layout_set_ellipsize(layout_, PANGO_ELLIPSIZE_END);
}

TextPainter::~TextPainter() {
  g_object_unref(layout_);
  g_object_unref(context_);
  g_object_unref(fonts_);
}

PangoLayout* TextPainter::lay_out(const std::string& text, double size, double width, int lines) {
  g_autofree char* valid = g_utf8_make_valid(text.c_str(), -1);
  pango_layout_set_text(layout_, valid, -1);
  g_autoptr(PangoFontDescription) font = pango_font_description_from_string("Sans");
  pango_font_description_set_absolute_size(font, size * PANGO_SCALE);
  pango_layout_set_font_description(layout_, font);
  pango_layout_set_height(layout_, -lines);
  pango_layout_set_alignment(layout_, lines > 1 ? PANGO_ALIGN_CENTER : PANGO_ALIGN_LEFT);
  pango_layout_set_width(layout_, static_cast<int>(width * PANGO_SCALE));
  return layout_;
}

}  // namespace calvin::gst

#endif
