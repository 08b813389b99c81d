// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws a mark as a mask, and keeps it.

#include "calvin/draw/overlay_marks.hpp"

#include <cmath>
#include <numbers>

namespace calvin {

namespace {

constexpr int kParts = 4;            // of a px: finer nobody sees
constexpr std::size_t kMost = 1000;  // masks, of some hundred bytes each

int in_parts(double px) { return static_cast<int>(std::lround(px * kParts)); }
double in_px(int parts) { return static_cast<double>(parts) / kParts; }

}  // namespace

void MarkMasks::paint(cairo_t* cr, const Shape& shape, const Colour& colour, double grow) {
  const bool disc = shape.kind == Shape::Kind::kDisc;
  const int u = in_parts(shape.from.u);
  const int v = in_parts(shape.from.v);
  const auto pixel = [](int parts) { return static_cast<int>(std::floor(in_px(parts))); };
  const Mask& mask = mask_of({shape.kind, in_parts(shape.radius + (disc ? grow : 0)),
                              disc ? 0 : in_parts(shape.width + 2 * grow), u - kParts * pixel(u),
                              v - kParts * pixel(v)});
  cairo_set_source_rgba(cr, colour.red, colour.green, colour.blue, colour.alpha);
  // The origin is the centre of the first pixel, and the mask begins at the edge of one.
  cairo_mask_surface(cr, mask.alpha.get(), pixel(u) - mask.reach - 0.5,
                     pixel(v) - mask.reach - 0.5);
}

const MarkMasks::Mask& MarkMasks::mask_of(const Key& key) {
  if (const auto known = masks_.find(key); known != masks_.end()) return known->second;
  if (masks_.size() >= kMost) masks_.clear();
  const auto& [kind, radius, width, u, v] = key;
  Mask mask;
  mask.reach = static_cast<int>(std::ceil(in_px(radius) + in_px(width) / 2)) + 1;
  const int side = 2 * mask.reach + 2;
  mask.alpha.reset(cairo_image_surface_create(CAIRO_FORMAT_A8, side, side));
  const CairoContext cr(cairo_create(mask.alpha.get()));
  cairo_set_antialias(cr.get(), CAIRO_ANTIALIAS_FAST);
  cairo_set_line_width(cr.get(), in_px(width));
  cairo_arc(cr.get(), mask.reach + 0.5 + in_px(u), mask.reach + 0.5 + in_px(v), in_px(radius), 0,
            2 * std::numbers::pi);
  if (kind == Shape::Kind::kDisc) {
    cairo_fill(cr.get());
  } else {
    cairo_stroke(cr.get());
  }
  return masks_.emplace(key, std::move(mask)).first->second;
}

}  // namespace calvin
