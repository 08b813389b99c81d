// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a blurred dot adds to a blurred edge: the product of how much of a pixel the dot covers and
// how much of it the edge leaves in the other colour. A dot meets its edge at right angles, where
// that is exact.

#include "calvin/detect/checkerboard/corners/edge_dots.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/checkerboard/corners/fit_window.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"

namespace calvin::detect {

namespace {

constexpr float kFar = 3;  // widths: nothing of an edge is left there

// The integral of the normal distribution (Page's approximation, to 2e-4).
float normal_integral(float x) {
  constexpr float kScale = 0.7978846F;
  return 0.5F + 0.5F * std::tanh(kScale * x * (1 + 0.044715F * x * x));
}

// One dot before the edges of a fit.
class BlurredDot {
 public:
  BlurredDot(const SaddleFit& fit, const EdgeDot& dot)
      : center_(dot.center), edge_(dot.on_along ? fit.along : fit.down) {
    const float area = cross(dot.along_edge, dot.across);
    by_along_ = {dot.across.y / area, -dot.across.x / area};
    by_across_ = {-dot.along_edge.y / area, dot.along_edge.x / area};
    radius_ = std::sqrt(std::abs(area));
    width_ = dot.on_along ? fit.along_width : fit.down_width;
    // Between along and down it is bright for a positive contrast; beyond the corner the sides of
    // an edge have exchanged their colours. A light dot shows where it is dark.
    const bool is_behind = detect::dot(dot.center, edge_) < 0;
    side_ = dot.on_along ? 1.0F : -1.0F;
    if (is_behind != (fit.contrast < 0)) side_ = -side_;
    if (dot.light) side_ = -side_;
    added_ = (dot.light ? 2 : -2) * std::abs(fit.contrast);
    farthest_ = 1 + kFar * width_ / radius_;
  }

  // grey levels, at a point from the corner
  [[nodiscard]] float at(Direction p) const {
    const Direction q = {p.x - center_.x, p.y - center_.y};
    const float s = detect::dot(by_along_, q);
    const float t = detect::dot(by_across_, q);
    const float square = s * s + t * t;
    if (square > farthest_ * farthest_) return 0;
    const float rho = std::sqrt(square);
    // px, from the rim outwards; a blurred disc is smaller than the disc.
    const Direction slope = {s * by_along_.x + t * by_across_.x,
                             s * by_along_.y + t * by_across_.y};
    const float steep = rho > 0 ? std::sqrt(detect::dot(slope, slope)) / rho : 1 / radius_;
    const float outside = (rho - 1) / steep + 0.5F * width_ * width_ / radius_;
    const float covered = normal_integral(-outside / width_);
    const float other = normal_integral(side_ * cross(edge_, p) / width_);
    return added_ * covered * other;
  }

 private:
  Direction center_;
  Direction edge_;
  Direction by_along_;  // takes a point to the unit disc
  Direction by_across_;
  float radius_ = 1;  // px
  float width_ = 1;   // px
  float side_ = 1;    // of the edge, on which the dot shows
  float added_ = 0;   // grey levels
  float farthest_ = 1;
};

// The grey level of a fit without dots, at a point from its corner.
float plain_grey(const SaddleFit& fit, Direction p) {
  const float a = 2 * normal_integral(cross(fit.along, p) / fit.along_width) - 1;
  const float b = 2 * normal_integral(cross(p, fit.down) / fit.down_width) - 1;
  return std::clamp(fit.level + fit.contrast * a * b, 0.0F, 255.0F);
}

}  // namespace

void remove_dots(const SaddleFit& fit, float x, float y, Window& window) noexcept {
  constexpr float kAny = 1;  // grey levels
  for (int k = 0; k < fit.dots.count; ++k) {
    const BlurredDot dot(fit, fit.dots.all[static_cast<std::size_t>(k)]);
    for (int i = 0; i < window.count; ++i) {
      const Direction p = {window.x[i] - x, window.y[i] - y};
      const float added = dot.at(p);
      if (added == 0) continue;
      // How bright a pixel would be that is white nobody knows: it tells nothing of the corner.
      const bool is_cut_off = window.grey[i] <= 0 || window.grey[i] >= 255;
      window.grey[i] =
          is_cut_off && std::abs(added) > kAny ? plain_grey(fit, p) : window.grey[i] - added;
    }
  }
}

}  // namespace calvin::detect
