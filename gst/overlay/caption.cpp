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

namespace calvin::gst {

namespace {

constexpr int kNarrowest = 64;  // px of a frame that has room for words

// Everything in px of the frame.
struct Sizes {
  explicit Sizes(ImageSize frame)
      : font(std::max(9.0, std::min(frame.width, frame.height) / 28.0)),
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

// Where a line of words may begin: at the top, behind the panel.
int left_of(ImageSize frame, Caption::Place place) {
  return place == Caption::Place::kTop ? std::min(overlay_panel_right(frame), frame.width / 2) : 0;
}

// A tile of this size in the middle of the room along an edge, at multiples of 4 as all tiles.
OverlayTile placed(ImageSize frame, const Sizes& sizes, Caption::Place place, int width,
                   int height) {
  const int left = left_of(frame, place);
  const auto margin = static_cast<int>(sizes.margin);
  OverlayTile tile;
  tile.width = std::min(width, frame.width - left);
  tile.height = std::min(height, frame.height);
  tile.x = (left + (frame.width - left - tile.width) / 2) / 4 * 4;
  const int y = place == Caption::Place::kTop ? margin : frame.height - tile.height - margin;
  tile.y = std::clamp(y, 0, frame.height - tile.height) / 4 * 4;
  tile.pixels.resize(4 * static_cast<std::size_t>(tile.width) *
                     static_cast<std::size_t>(tile.height));
  return tile;
}

}  // namespace

// A font map of its own: Pango's default one belongs to a thread.
struct Caption::Renderer {
  Renderer()
      : fonts(pango_cairo_font_map_new()),
        context(pango_font_map_create_context(fonts)),
        layout(pango_layout_new(context)) {
    pango_layout_set_single_paragraph_mode(layout, TRUE);
    pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_END);
    pango_layout_set_height(layout, -2);  // two lines at the most
    pango_layout_set_alignment(layout, PANGO_ALIGN_CENTER);
  }
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  ~Renderer() {
    g_object_unref(layout);
    g_object_unref(context);
    g_object_unref(fonts);
  }

  OverlayTile draw(const std::string& text, ImageSize frame, Place place) {
    const Sizes sizes(frame);
    g_autofree char* valid = g_utf8_make_valid(text.c_str(), -1);
    pango_layout_set_text(layout, valid, -1);
    g_autoptr(PangoFontDescription) font = pango_font_description_from_string("Sans");
    pango_font_description_set_absolute_size(font, sizes.font * PANGO_SCALE);
    pango_layout_set_font_description(layout, font);
    const double room = frame.width - left_of(frame, place) - 2 * (sizes.margin + sizes.padding);
    pango_layout_set_width(layout, static_cast<int>(room * PANGO_SCALE));
    PangoRectangle logical;
    pango_layout_get_pixel_extents(layout, nullptr, &logical);

    OverlayTile tile =
        placed(frame, sizes, place, logical.width + static_cast<int>(2 * sizes.padding),
               logical.height + static_cast<int>(sizes.padding));
    const CairoSurface surface(cairo_image_surface_create_for_data(
        tile.pixels.data(), CAIRO_FORMAT_ARGB32, tile.width, tile.height, 4 * tile.width));
    const CairoContext painter(cairo_create(surface.get()));
    cairo_t* cr = painter.get();
    rounded_box(cr, tile.width, tile.height, tile.height / 4.0);
    cairo_set_source_rgba(cr, 0, 0, 0, 0.6);
    cairo_fill(cr);
    cairo_move_to(cr, sizes.padding - logical.x, sizes.padding / 2 - logical.y);
    cairo_set_source_rgb(cr, 1, 1, 1);
    pango_cairo_show_layout(cr, layout);
    cairo_surface_finish(surface.get());
    return tile;
  }

  PangoFontMap* fonts;
  PangoContext* context;
  PangoLayout* layout;
};

Caption::Caption() = default;
Caption::~Caption() = default;

const OverlayTile* Caption::draw(const std::string& text, ImageSize frame, Place place) {
  if (text.empty() || std::min(frame.width, frame.height) < kNarrowest) return nullptr;
  Drawn& drawn = place == Place::kTop ? top_ : bottom_;
  if (text == drawn.text && frame == drawn.frame) return &drawn.tile;
  if (!renderer_) renderer_ = std::make_unique<Renderer>();
  drawn = {text, frame, renderer_->draw(text, frame, place)};
  return &drawn.tile;
}

}  // namespace calvin::gst

#else

namespace calvin::gst {

struct Caption::Renderer {};

Caption::Caption() = default;
Caption::~Caption() = default;

const OverlayTile* Caption::draw(const std::string& /*text*/, ImageSize /*frame*/,
                                 Place /*place*/) {
  return nullptr;
}

}  // namespace calvin::gst

#endif
