// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws words with Pango, white in a dark outline.

#include "overlay/labels.hpp"

#include "calvin_config.h"

#if CALVIN_HAVE_PANGO

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <pango/pangocairo.h>

#include "calvin/draw/cairo.hpp"
#include "overlay/text_painter.hpp"

namespace calvin::gst {

namespace {

constexpr double kSmallest = 5;  // px of a font that anybody can read

// Around the words, at multiples of 4 as all tiles, in the frame.
OverlayTile around(std::span<const OverlayWords> words, ImageSize frame) {
  double left = frame.width;
  double top = frame.height;
  double right = 0;
  double bottom = 0;
  for (const OverlayWords& w : words) {
    left = std::min(left, w.at.u - w.size / 4);
    right = std::max(right, w.at.u + w.width);
    top = std::min(top, w.at.v - w.size);
    bottom = std::max(bottom, w.at.v + w.size);
  }
  OverlayTile tile;
  tile.serial = next_tile_serial();
  tile.x = std::clamp(static_cast<int>(left), 0, frame.width) / 4 * 4;
  tile.y = std::clamp(static_cast<int>(top), 0, frame.height) / 4 * 4;
  tile.width = std::clamp(static_cast<int>(std::ceil(right)), 0, frame.width) - tile.x;
  tile.height = std::clamp(static_cast<int>(std::ceil(bottom)), 0, frame.height) - tile.y;
  return tile;
}

// What of each pixel the words cover.
CairoSurface cover_of(TextPainter& painter, std::span<const OverlayWords> words,
                      const OverlayTile& tile) {
  CairoSurface cover(cairo_image_surface_create(CAIRO_FORMAT_A8, tile.width, tile.height));
  const CairoContext context(cairo_create(cover.get()));
  for (const OverlayWords& w : words) {
    PangoLayout* layout = painter.lay_out(w.text, w.size, w.width, 1);
    PangoRectangle logical;
    pango_layout_get_pixel_extents(layout, nullptr, &logical);
    cairo_move_to(context.get(), w.at.u + 0.5 - tile.x,
                  w.at.v + 0.5 - tile.y - logical.height / 2.0);
    pango_cairo_show_layout(context.get(), layout);
  }
  return cover;
}

// What the outline covers: the words, moved by its width into every direction. To stroke the paths
// of the letters instead takes milliseconds, in which a camera's next frame is due.
CairoSurface outline_of(const CairoSurface& words, const OverlayTile& tile, double width) {
  constexpr int kDirections = 8;
  CairoSurface outline(cairo_image_surface_create(CAIRO_FORMAT_A8, tile.width, tile.height));
  const CairoContext context(cairo_create(outline.get()));
  cairo_set_operator(context.get(), CAIRO_OPERATOR_ADD);
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirections;
    // Whole pixels, which pixman adds many at a time.
    cairo_set_source_surface(context.get(), words.get(), std::round(width * std::cos(angle)),
                             std::round(width * std::sin(angle)));
    cairo_paint(context.get());
  }
  return outline;
}

// Without pixels where the words are beyond the border.
OverlayTile draw_words(TextPainter& painter, std::span<const OverlayWords> words, ImageSize frame) {
  OverlayTile tile = around(words, frame);
  if (tile.width < 1 || tile.height < 1) return tile;
  tile.pixels.resize(4 * static_cast<std::size_t>(tile.width) *
                     static_cast<std::size_t>(tile.height));
  const CairoSurface surface(cairo_image_surface_create_for_data(
      tile.pixels.data(), CAIRO_FORMAT_ARGB32, tile.width, tile.height, 4 * tile.width));
  const CairoContext context(cairo_create(surface.get()));
  const CairoSurface cover = cover_of(painter, words, tile);
  const CairoSurface outline = outline_of(cover, tile, words.front().size / 10);
  cairo_set_source_rgba(context.get(), 0, 0, 0, 0.75);
  cairo_mask_surface(context.get(), outline.get(), 0, 0);
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_mask_surface(context.get(), cover.get(), 0, 0);
  cairo_surface_finish(surface.get());
  return tile;
}

}  // namespace

Labels::Labels(Tiles tiles) : kind_(tiles) {}
Labels::~Labels() = default;

bool Labels::can_draw() noexcept { return true; }

std::span<const OverlayTile> Labels::draw(std::vector<OverlayWords> words, ImageSize frame) {
  if (words.empty() || words.front().size < kSmallest) return {};
  if (words == words_ && frame == frame_) return tiles_;
  if (!painter_) painter_ = std::make_unique<TextPainter>();
  std::vector<OverlayTile> tiles;
  if (kind_ == Tiles::kOne) {
    tiles.push_back(draw_words(*painter_, words, frame));
  } else {
    for (const OverlayWords& one : words) {
      const auto known = frame == frame_ ? std::ranges::find(words_, one) : words_.end();
      tiles.push_back(known == words_.end()
                          ? draw_words(*painter_, {&one, 1}, frame)
                          : std::move(tiles_[static_cast<std::size_t>(known - words_.begin())]));
    }
  }
  tiles_ = std::move(tiles);
  words_ = std::move(words);
  frame_ = frame;
  return tiles_;
}

}  // namespace calvin::gst

#else

namespace calvin::gst {

class TextPainter {};

Labels::Labels(Tiles tiles) : kind_(tiles) {}
Labels::~Labels() = default;

bool Labels::can_draw() noexcept { return false; }

std::span<const OverlayTile> Labels::draw(std::vector<OverlayWords> /*words*/,
                                          ImageSize /*frame*/) {
  return {};
}

}  // namespace calvin::gst

#endif
