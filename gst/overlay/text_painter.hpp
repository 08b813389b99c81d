// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lays words out. Only in a build with Pango.
#pragma once

#include <string>

#include <pango/pangocairo.h>

namespace calvin::gst {

// One thread at a time.
class TextPainter {
 public:
  TextPainter();
  TextPainter(const TextPainter&) = delete;
  TextPainter& operator=(const TextPainter&) = delete;
  ~TextPainter();

  // The words in so many lines at the most, what does not fit cut off; `size` of the font and
  // `width` px. Good until the next call.
  PangoLayout* lay_out(const std::string& text, double size, double width, int lines);
  // What the last call made.
  [[nodiscard]] PangoLayout* layout() const { return layout_; }

 private:
  // A font map of its own: Pango's default one belongs to a thread.
  PangoFontMap* fonts_;
  PangoContext* context_;
  PangoLayout* layout_;
};

}  // namespace calvin::gst
