// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Paints a scene with Cairo, what is farthest away first.

#include "calvin/draw/scene/scene_picture.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "calvin_config.h"

#if CALVIN_HAVE_CAIRO
#include "calvin/draw/cairo.hpp"
#endif

namespace calvin {

#if CALVIN_HAVE_CAIRO

namespace {

constexpr SceneColour kBackground = {0.075, 0.086, 0.105, 1};
constexpr SceneColour kText = {0.80, 0.83, 0.87, 1};

void set_colour(cairo_t* to, const SceneColour& colour, double alpha = 1) {
  cairo_set_source_rgba(to, colour.red, colour.green, colour.blue, alpha * colour.alpha);
}

// What a picture of any size has in common: lines and text grow with it.
double unit_of(ImageSize size) { return std::max(1.0, std::min(size.width, size.height) / 540.0); }

class ScenePainter {
 public:
  ScenePainter(const Scene& scene, const SceneProjection& projection, ImageSize size, cairo_t* to)
      : scene_(scene), projection_(projection), size_(size), unit_(unit_of(size)), to_(to) {}

  void paint() {
    set_colour(to_, kBackground);
    cairo_paint(to_);
    cairo_set_line_join(to_, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(to_, CAIRO_LINE_CAP_ROUND);
    for (const std::size_t i : by_depth()) paint_path(scene_.paths[i]);
    cairo_select_font_face(to_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    paint_labels();
    paint_notes();
  }

 private:
  [[nodiscard]] std::vector<std::size_t> by_depth() const {
    std::vector<double> depths;
    for (const ScenePath& path : scene_.paths) {
      double sum = 0;
      for (const Eigen::Vector3d& p : path.points) sum += projection_.depth(p);
      depths.push_back(sum / static_cast<double>(std::max<std::size_t>(path.points.size(), 1)));
    }
    std::vector<std::size_t> order(scene_.paths.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return depths[i]; });
    return order;
  }

  // What is far away is fainter.
  [[nodiscard]] double light(const ScenePath& path) const {
    double nearest = 1e300;
    for (const Eigen::Vector3d& p : path.points) {
      nearest = std::min(nearest, projection_.depth(p));
    }
    const double behind = (nearest - projection_.distance()) / scene_.radius;  // -1..1
    return std::clamp(0.85 - 0.25 * behind, 0.5, 1.0);
  }

  void paint_path(const ScenePath& path) {
    cairo_new_path(to_);
    for (const Pixel& at : projection_.project(path)) {
      cairo_line_to(to_, at.u + 0.5, at.v + 0.5);
    }
    if (path.is_closed) cairo_close_path(to_);
    set_colour(to_, path.colour, light(path));
    if (path.is_filled) {
      cairo_fill(to_);
    } else {
      cairo_set_line_width(to_, unit_ * path.width);
      cairo_stroke(to_);
    }
  }

  struct TextBox {
    double left, top, right, bottom;
    [[nodiscard]] bool meets(const TextBox& other) const {
      return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
  };

  // Beside what they name, and below each other where they would overlap.
  void paint_labels() {
    const double height = 13 * unit_;
    cairo_set_font_size(to_, height);
    std::vector<TextBox> taken;
    for (const SceneLabel& label : scene_.labels) {
      const auto at = projection_.project(label.at);
      if (!at) continue;
      cairo_text_extents_t extents;
      cairo_text_extents(to_, label.text.c_str(), &extents);
      TextBox box = {at->u + 7 * unit_, at->v - 7 * unit_ - height,
                     at->u + 7 * unit_ + extents.x_advance, at->v - 7 * unit_};
      const auto overlaps = [&] {
        return std::ranges::any_of(taken, [&](const TextBox& b) { return b.meets(box); });
      };
      for (int tries = 0; tries < 40 && overlaps(); ++tries) {
        box.top += 0.5 * height;
        box.bottom += 0.5 * height;
      }
      taken.push_back(box);
      write(label.text, box.left, box.bottom, label.colour);
    }
  }

  void paint_notes() {
    const double height = 12 * unit_;
    cairo_set_font_size(to_, height);
    double bottom = size_.height - 12 * unit_;
    for (auto note = scene_.notes.rbegin(); note != scene_.notes.rend(); ++note) {
      write(*note, 14 * unit_, bottom, kText);
      bottom -= 1.5 * height;
    }
  }

  // With a dark rim, so that lines behind it do not cut it.
  void write(const std::string& text, double left, double bottom, const SceneColour& colour) {
    cairo_move_to(to_, left, bottom);
    cairo_text_path(to_, text.c_str());
    set_colour(to_, kBackground, 0.85);
    cairo_set_line_width(to_, 3 * unit_);
    cairo_stroke_preserve(to_);
    set_colour(to_, colour);
    cairo_fill(to_);
  }

  const Scene& scene_;
  const SceneProjection& projection_;
  ImageSize size_;
  double unit_;
  cairo_t* to_;
};

}  // namespace

Status draw_scene(const Scene& scene, const SceneViewpoint& viewpoint, ImageSize size,
                  std::uint8_t* pixels, std::ptrdiff_t stride) {
  const CairoSurface surface(cairo_image_surface_create_for_data(
      pixels, CAIRO_FORMAT_RGB24, size.width, size.height, static_cast<int>(stride)));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The view of the rig cannot be drawn into a picture of this size.");
  }
  const CairoContext context(cairo_create(surface.get()));
  const SceneProjection projection(scene, viewpoint, size);
  ScenePainter(scene, projection, size, context.get()).paint();
  cairo_surface_flush(surface.get());
  return {};
}

#else

Status draw_scene(const Scene& /*scene*/, const SceneViewpoint& /*viewpoint*/, ImageSize /*size*/,
                  std::uint8_t* /*pixels*/, std::ptrdiff_t /*stride*/) {
  return make_error(ErrorCode::kUnsupported,
                    "This build cannot draw: it was made without Cairo. Build it with "
                    "-Ddraw=enabled.");
}

#endif

}  // namespace calvin
