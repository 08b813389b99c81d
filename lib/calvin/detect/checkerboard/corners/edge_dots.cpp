// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a blurred dot adds to a blurred edge, a vector at a time: the product of how much of a pixel
// the dot covers and how much of it the edge leaves in the other colour. A dot meets its edge at
// right angles, where that is exact.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/checkerboard/corners/edge_dots.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>
// The error function is included once for each target, too.
#include "calvin/detect/error_function-inl.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/checkerboard/corners/edge_dots.hpp"
#include "calvin/detect/checkerboard/corners/fit_window.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"

#ifndef CALVIN_DETECT_BLURRED_DOT
#define CALVIN_DETECT_BLURRED_DOT
namespace calvin::detect {

// One dot before the edges of a fit.
struct BlurredDot {
  BlurredDot(const SaddleFit& fit, const EdgeDot& dot)
      : center(dot.center), edge(dot.on_along ? fit.along : fit.down) {
    constexpr float kFar = 3;  // widths: nothing of an edge is left there
    const float area = cross(dot.along_edge, dot.across);
    by_along = {dot.across.y / area, -dot.across.x / area};
    by_across = {-dot.along_edge.y / area, dot.along_edge.x / area};
    radius = std::sqrt(std::abs(area));
    width = dot.on_along ? fit.along_width : fit.down_width;
    // Between along and down it is bright for a positive contrast; beyond the corner the sides of
    // an edge have exchanged their colours. A light dot shows where it is dark.
    const bool is_behind = detect::dot(dot.center, edge) < 0;
    side = dot.on_along ? 1.0F : -1.0F;
    if (is_behind != (fit.contrast < 0)) side = -side;
    if (dot.light) side = -side;
    added = (dot.light ? 2 : -2) * std::abs(fit.contrast);
    farthest = 1 + kFar * width / radius;
    half_height =
        farthest * std::sqrt(dot.along_edge.y * dot.along_edge.y + dot.across.y * dot.across.y);
  }

  Direction center;
  Direction edge;
  Direction by_along;  // takes a point to the unit disc
  Direction by_across;
  float radius = 1;       // px
  float width = 1;        // px
  float side = 1;         // of the edge, on which the dot shows
  float added = 0;        // grey levels
  float farthest = 1;     // from the middle, in the unit disc, of what it adds
  float half_height = 0;  // px, likewise in the image
};

}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

inline constexpr float kRoot = 0.70710678F;  // a Gaussian's sigma is 1/sqrt(2) of the erf's scale

HWY_INLINE V all(float v) { return hn::Set(D(), v); }

// What a Gaussian blur of 1 sigma makes of an edge from -1 to 1, at a distance of x / kRoot.
HWY_INLINE V blurred_edge(V x) {
  const ErrorFunction<V> error(D(), x);
  V slope;
  return error.value(D(), x, hn::Div(all(1), error.p), slope);
}

// The share of the bright side.
HWY_INLINE V normal_integral(V x) { return hn::MulAdd(all(0.5F), blurred_edge(x), all(0.5F)); }

HWY_INLINE V cross_with(Direction a, V x, V y) {
  return hn::Sub(hn::Mul(all(a.x), y), hn::Mul(all(a.y), x));
}

// What a dot adds, grey levels, at points from the corner of which (s, t) are the coordinates in
// the unit disc and `square` the square of the distance from its middle there.
HWY_INLINE V added_by(const BlurredDot& dot, V x, V y, V s, V t, V square) {
  const V rho = hn::Sqrt(hn::Max(square, all(1e-12F)));
  // px, from the rim outwards; a blurred disc is smaller than the disc.
  const V slope_x = hn::MulAdd(s, all(dot.by_along.x), hn::Mul(t, all(dot.by_across.x)));
  const V slope_y = hn::MulAdd(s, all(dot.by_along.y), hn::Mul(t, all(dot.by_across.y)));
  const V slope = hn::Sqrt(hn::MulAdd(slope_x, slope_x, hn::Mul(slope_y, slope_y)));
  // In the middle, where there is no slope, all is covered.
  const V per_px = hn::Div(rho, hn::Max(slope, all(1e-9F)));
  const V outside =
      hn::MulAdd(hn::Sub(rho, all(1)), per_px, all(0.5F * dot.width * dot.width / dot.radius));
  const V covered = normal_integral(hn::Mul(outside, all(-kRoot / dot.width)));
  const V other =
      normal_integral(hn::Mul(cross_with(dot.edge, x, y), all(kRoot * dot.side / dot.width)));
  return hn::Mul(all(dot.added), hn::Mul(covered, other));
}

// The grey level of a fit without dots, at points from its corner.
HWY_INLINE V plain_grey(const SaddleFit& fit, V x, V y) {
  const V a = blurred_edge(hn::Mul(cross_with(fit.along, x, y), all(kRoot / fit.along_width)));
  const V b = blurred_edge(hn::Mul(cross_with(fit.down, x, y), all(-kRoot / fit.down_width)));
  const V grey = hn::MulAdd(all(fit.contrast), hn::Mul(a, b), all(fit.level));
  return hn::Min(hn::Max(grey, all(0)), all(255));
}

void remove_dot(const SaddleFit& fit, const BlurredDot& dot, float x, float y, Window& window) {
  constexpr float kAny = 1;  // grey levels
  const D d;
  const V most = all(dot.farthest * dot.farthest);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const float top = y + dot.center.y - dot.half_height;
  const float bottom = y + dot.center.y + dot.half_height;
  for (int i = 0; i < window.count; i += lanes) {
    // A window has its pixels row by row.
    if (window.y[std::min(i + lanes, window.count) - 1] < top) continue;
    if (window.y[i] > bottom) break;
    const V px = hn::Sub(hn::LoadU(d, window.x + i), all(x));
    const V py = hn::Sub(hn::LoadU(d, window.y + i), all(y));
    const V qx = hn::Sub(px, all(dot.center.x));
    const V qy = hn::Sub(py, all(dot.center.y));
    const V s = hn::MulAdd(all(dot.by_along.x), qx, hn::Mul(all(dot.by_along.y), qy));
    const V t = hn::MulAdd(all(dot.by_across.x), qx, hn::Mul(all(dot.by_across.y), qy));
    const V square = hn::MulAdd(s, s, hn::Mul(t, t));
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(window.count - i));
    const auto near = hn::And(inside, hn::Le(square, most));
    if (hn::AllFalse(d, near)) continue;
    const V added = added_by(dot, px, py, s, t, square);
    const V grey = hn::LoadU(d, window.grey + i);
    V left = hn::Sub(grey, added);
    // How bright a pixel would be that is white nobody knows: it tells nothing of the corner.
    const auto is_cut_off = hn::Or(hn::Le(grey, all(0)), hn::Ge(grey, all(255)));
    const auto is_unknown = hn::And(is_cut_off, hn::Gt(hn::Abs(added), all(kAny)));
    if (!hn::AllFalse(d, hn::And(near, is_unknown))) {
      left = hn::IfThenElse(is_unknown, plain_grey(fit, px, py), left);
    }
    hn::StoreU(hn::IfThenElse(near, left, grey), d, window.grey + i);
  }
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(remove_dot);

}  // namespace

void remove_dots(const SaddleFit& fit, float x, float y, Window& window) noexcept {
  for (int k = 0; k < fit.dots.count; ++k) {
    const BlurredDot dot(fit, fit.dots.all[static_cast<std::size_t>(k)]);
    HWY_DYNAMIC_DISPATCH(remove_dot)(fit, dot, x, y, window);
  }
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
