// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws the words with Pango on a dark box in the middle of an edge.

#include "overlay/caption.hpp"

#include "calvin_config.h"

#if CALVIN_HAVE_PANGO

#include <algorithm>
#include <numbers>

#include <pango/pangocairo.h>

#include "calvin/draw/cairo.hpp"
#include "overlay/text_painter.hpp"

namespace calvin::gst {

namespace {

constexpr int kNarrowest = 64;  // px of a frame that has room for words

constexpr double kSmallestFont = 9;  // px

// Everything in px of the frame.
struct Sizes {
  explicit Sizes(ImageSize frame, double smaller = 1)
      : font(std::max(kSmallestFont, smaller * std::min(frame.width, frame.height) / 28.0)),
        padding(font / 2),
        margin(font / 2) {}
  double font;
  double padding;
  double margin;
};

void rounded_box(cairo_t* cr, double width, double height, double radius) {
  constexpr double kQuarter = std::numbers::pi / 2;
  cairo_arc(cr, width - radius, radius, radius, -kQuarter, 0);
  cairo_arc(cr, width - radius, height - radius, radius, 0, kQuarter);
  cairo_arc(cr, radius, height - radius, radius, kQuarter, 2 * kQuarter);
  cairo_arc(cr, radius, radius, radius, 2 * kQuarter, 3 * kQuarter);
  cairo_close_path(cr);
}

// A tile of this size in the middle of the room along an edge, at multiples of 4 as all tiles.
OverlayTile placed(ImageSize frame, const Sizes& sizes, OverlaySpan room, Caption::Place place,
                   int width, int height) {
  const auto margin = static_cast<int>(sizes.margin);
  OverlayTile tile;
  tile.serial = next_tile_serial();
  tile.width = std::min(width, room.right - room.left);
  tile.height = std::min(height, frame.height);
  tile.x = (room.left + (room.right - room.left - tile.width) / 2) / 4 * 4;
  const int y = place == Caption::Place::kTop ? margin : frame.height - tile.height - margin;
  tile.y = std::clamp(y, 0, frame.height - tile.height) / 4 * 4;
  tile.pixels.resize(4 * static_cast<std::size_t>(tile.width) *
                     static_cast<std::size_t>(tile.height));
  return tile;
}

// The sizes at which all of the text has room, or else the smallest; the layout has that.
Sizes fit_words(TextPainter& painter, const Caption::Words& words, OverlaySpan room) {
  constexpr int kLines = 3;  // on a small frame
  constexpr double kSmaller[] = {1, 0.85, 0.7};
  Sizes sizes(words.frame);
  for (const double smaller : kSmaller) {
    sizes = Sizes(words.frame, smaller);
    const double width = room.right - room.left - 2 * (sizes.margin + sizes.padding);
    PangoLayout* layout = painter.lay_out(words.text, sizes.font, width, kLines);
    if (pango_layout_is_ellipsized(layout) == FALSE) break;
  }
  return sizes;
}

OverlayTile draw_words(TextPainter& painter, const Caption::Words& words, Caption::Place place) {
  const OverlaySpan room =
      place == Caption::Place::kTop ? words.room : OverlaySpan{0, words.frame.width};
  const Sizes sizes = fit_words(painter, words, room);
  PangoLayout* layout = painter.layout();
  PangoRectangle logical;
  pango_layout_get_pixel_extents(layout, nullptr, &logical);

  OverlayTile tile =
      placed(words.frame, sizes, room, place, logical.width + static_cast<int>(2 * sizes.padding),
             logical.height + static_cast<int>(sizes.padding));
  const CairoSurface surface(cairo_image_surface_create_for_data(
      tile.pixels.data(), CAIRO_FORMAT_ARGB32, tile.width, tile.height, 4 * tile.width));
  const CairoContext context(cairo_create(surface.get()));
  cairo_t* cr = context.get();
  rounded_box(cr, tile.width, tile.height, tile.height / 4.0);
  if (words.done) {
    cairo_set_source_rgba(cr, 0.05, 0.4, 0.12, 0.85);
  } else {
    cairo_set_source_rgba(cr, 0, 0, 0, 0.6);
  }
  cairo_fill(cr);
  cairo_move_to(cr, sizes.padding - logical.x, sizes.padding / 2 - logical.y);
  cairo_set_source_rgb(cr, 1, 1, 1);
  pango_cairo_show_layout(cr, layout);
  cairo_surface_finish(surface.get());
  return tile;
}

}  // namespace

Caption::Caption() = default;
Caption::~Caption() = default;

const OverlayTile* Caption::draw(const Words& words, Place place) {
  if (words.text.empty() || std::min(words.frame.width, words.frame.height) < kNarrowest) {
    return nullptr;
  }
  Drawn& drawn = place == Place::kTop ? top_ : bottom_;
  if (words == drawn.words) return &drawn.tile;
  if (!painter_) painter_ = std::make_unique<TextPainter>();
  drawn = {words, draw_words(*painter_, words, place)};
  return &drawn.tile;
}

}  // namespace calvin::gst

#else

namespace calvin::gst {

class TextPainter {};

Caption::Caption() = default;
Caption::~Caption() = default;

const OverlayTile* Caption::draw(const Words& /*words*/, Place /*place*/) { return nullptr; }

}  // namespace calvin::gst

#endif
