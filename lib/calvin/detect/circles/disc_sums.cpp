// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The normal equations of a blurred ellipse over its window's pixels, a vector at a time.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/circles/disc_sums.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>
// Included once for each target, too.
#include "calvin/detect/error_function-inl.hpp"

#include <utility>

#include "calvin/detect/circles/disc_sums.hpp"
#include "calvin/detect/unknown_pairs.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr UnknownPairs<kDiscUnknowns> kDiscPairs;

// A fit as its sums need it.
struct DiscModel {
  float x, y;     // px
  float a, b, c;  // 1/px^2, the inverse of the ellipse's matrix: [a b; b c]
  float unit;     // 1/px^2, of the unknowns for a, b and c
  float scale;    // 1 / (sqrt 2 width)
  float inside, change;
  float slope_x, slope_y;
};

// Row `i` of J and the following ones, and their errors.
template <class D, class V>
HWY_INLINE void disc_rows(D d, Window& window, const DiscModel& m, int i, V* j, V& e) {
  const auto set = [d](float v) { return hn::Set(d, v); };
  const V dx = hn::Sub(hn::LoadU(d, window.x + i), set(m.x));
  const V dy = hn::Sub(hn::LoadU(d, window.y + i), set(m.y));
  const V nx = hn::MulAdd(set(m.a), dx, hn::Mul(set(m.b), dy));
  const V ny = hn::MulAdd(set(m.b), dx, hn::Mul(set(m.c), dy));
  const V tiny = set(1e-6F);
  const V radii = hn::Sqrt(hn::Max(hn::MulAdd(nx, dx, hn::Mul(ny, dy)), tiny));
  const V inverse = hn::Div(set(1), hn::Sqrt(hn::Max(hn::MulAdd(nx, nx, hn::Mul(ny, ny)), tiny)));
  // Exact for a circle, and of the first order along the rim of an ellipse.
  const V distance = hn::Mul(hn::Mul(hn::Sub(radii, set(1)), radii), inverse);
  const V t = hn::Mul(distance, set(m.scale));
  const ErrorFunction<V> error(d, t);
  V by_t;
  const V edge = error.value(d, t, hn::Div(set(1), error.p), by_t);
  const V outside = hn::MulAdd(set(0.5F), edge, set(0.5F));
  const V light = hn::MulAdd(set(m.slope_x), dx, hn::MulAdd(set(m.slope_y), dy, set(1)));
  const V model = hn::Mul(light, hn::MulAdd(set(m.change), outside, set(m.inside)));
  // The last vectors may reach beyond the window.
  const auto in = hn::FirstN(d, static_cast<std::size_t>(std::max(window.count - i, 0)));
  e = hn::IfThenElseZero(in, hn::Sub(hn::LoadU(d, window.grey + i), model));
  hn::StoreU(e, d, window.error + i);
  const V kept = hn::IfThenElseZero(in, light);
  const V by_distance = hn::Mul(hn::Mul(kept, set(0.5F * m.change * m.scale)), by_t);
  const V along = hn::Mul(by_distance, inverse);
  j[kDiscX] = hn::Neg(hn::Mul(along, nx));
  j[kDiscY] = hn::Neg(hn::Mul(along, ny));
  const V shape = hn::Div(hn::Mul(along, set(0.5F * m.unit)), radii);
  j[kDiscXX] = hn::Mul(shape, hn::Mul(dx, dx));
  j[kDiscXY] = hn::Mul(hn::Mul(shape, set(2)), hn::Mul(dx, dy));
  j[kDiscYY] = hn::Mul(shape, hn::Mul(dy, dy));
  j[kDiscWidth] = hn::Neg(hn::Mul(by_distance, distance));
  j[kDiscInside] = hn::Mul(kept, hn::Sub(set(1), outside));
  j[kDiscOutside] = hn::Mul(kept, outside);
}

template <class V, std::size_t... K, std::size_t... P>
HWY_INLINE void add_disc(const V* j, V e, V* products, V* gradient, std::index_sequence<K...> /*k*/,
                         std::index_sequence<P...> /*p*/) {
  ((products[K] = hn::MulAdd(j[kDiscPairs.first[K]], j[kDiscPairs.second[K]], products[K])), ...);
  ((gradient[P] = hn::MulAdd(j[P], e, gradient[P])), ...);
}

void accumulate_disc(Window& window, const DiscFit& fit, float x, float y, DiscNormal& normal) {
  using D = hn::ScalableTag<float>;
  using V = hn::Vec<D>;
  const D d;
  constexpr double kRoot = 0.70710678;  // a Gaussian's sigma is 1/sqrt(2) of the erf's scale
  const Ellipse& s = fit.ellipse;
  const double determinant = s.determinant();
  const auto inverse = [&](double v) { return static_cast<float>(v / determinant); };
  const double radius = s.radius();
  const DiscModel model = {x,
                           y,
                           inverse(s.yy),
                           inverse(-s.xy),
                           inverse(s.xx),
                           static_cast<float>(2 / (radius * radius * radius)),
                           static_cast<float>(kRoot / fit.width),
                           s.inside,
                           s.outside - s.inside,
                           static_cast<float>(fit.slope_x),
                           static_cast<float>(fit.slope_y)};
  V products[kDiscProducts];
  V gradient[kDiscUnknowns];
  for (V& p : products) p = hn::Zero(d);
  for (V& g : gradient) g = hn::Zero(d);
  V square = hn::Zero(d);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < window.count; i += lanes) {
    V j[kDiscUnknowns];
    V e;
    disc_rows(d, window, model, i, j, e);
    square = hn::MulAdd(e, e, square);
    add_disc(j, e, products, gradient, std::make_index_sequence<kDiscProducts>(),
             std::make_index_sequence<kDiscUnknowns>());
  }
  for (int k = 0; k < kDiscProducts; ++k)
    normal.products[k] = hn::GetLane(hn::SumOfLanes(d, products[k]));
  for (int p = 0; p < kDiscUnknowns; ++p)
    normal.gradient[p] = hn::GetLane(hn::SumOfLanes(d, gradient[p]));
  normal.square = hn::GetLane(hn::SumOfLanes(d, square));
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(accumulate_disc);

}  // namespace

void accumulate_disc(Window& window, const DiscFit& fit, float x, float y,
                     DiscNormal& normal) noexcept {
  HWY_DYNAMIC_DISPATCH(accumulate_disc)(window, fit, x, y, normal);
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
