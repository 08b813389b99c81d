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
#include "calvin/detect/lane_sums-inl.hpp"

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

// A step of Newton's makes a quick root of at least 8 bits one of twice as many, and a second one a
// float's.
template <class D, class V>
HWY_INLINE V inverse_root(D d, V x) {
  const V half = hn::Mul(hn::Set(d, 0.5F), x);
  V root = hn::ApproximateReciprocalSqrt(x);
  for (int i = 0; i < 2; ++i) {
    root = hn::Mul(root, hn::NegMulAdd(hn::Mul(half, root), root, hn::Set(d, 1.5F)));
  }
  return root;
}

// Row `i` of J and the following ones, and their errors.
template <class D, class V>
HWY_INLINE void disc_rows(D d, Window& window, const DiscModel& m, int i, V* j, V& e) {
  const auto set = [d](float v) { return hn::Set(d, v); };
  const V dx = hn::Sub(hn::LoadU(d, window.x + i), set(m.x));
  const V dy = hn::Sub(hn::LoadU(d, window.y + i), set(m.y));
  const V nx = hn::MulAdd(set(m.a), dx, hn::Mul(set(m.b), dy));
  const V ny = hn::MulAdd(set(m.b), dx, hn::Mul(set(m.c), dy));
  const V tiny = set(1e-6F);
  const V square_radii = hn::Max(hn::MulAdd(nx, dx, hn::Mul(ny, dy)), tiny);
  const V by_radii = inverse_root(d, square_radii);
  const V radii = hn::Mul(square_radii, by_radii);
  const V inverse = inverse_root(d, hn::Max(hn::MulAdd(nx, nx, hn::Mul(ny, ny)), tiny));
  // Exact for a circle, and of the first order along the rim of an ellipse.
  const V distance = hn::Mul(hn::Mul(hn::Sub(radii, set(1)), radii), inverse);
  const V t = hn::Mul(distance, set(m.scale));
  const ErrorFunction<V> error(d, t);
  V by_t;
  const V near = hn::ApproximateReciprocal(error.p);
  const V by_p = hn::Mul(near, hn::NegMulAdd(near, error.p, set(2)));
  const V edge = error.value(d, t, by_p, by_t);
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
  const V shape = hn::Mul(hn::Mul(along, set(0.5F * m.unit)), by_radii);
  j[kDiscXX] = hn::Mul(shape, hn::Mul(dx, dx));
  j[kDiscXY] = hn::Mul(hn::Mul(shape, set(2)), hn::Mul(dx, dy));
  j[kDiscYY] = hn::Mul(shape, hn::Mul(dy, dy));
  j[kDiscWidth] = hn::Neg(hn::Mul(by_distance, distance));
  j[kDiscInside] = hn::Mul(kept, hn::Sub(set(1), outside));
  j[kDiscOutside] = hn::Mul(kept, outside);
}

// Two vectors of pixels are summed at a time: there are more sums than registers.
inline constexpr int kDiscTogether = 2;

template <class V, std::size_t... K, std::size_t... P>
HWY_INLINE void add_disc(const V (*j)[kDiscUnknowns], const V* e, [[maybe_unused]] V* products,
                         V* gradient, std::index_sequence<K...> /*k*/,
                         std::index_sequence<P...> /*p*/) {
  ((products[K] =
        hn::MulAdd(j[1][kDiscPairs.first[K]], j[1][kDiscPairs.second[K]],
                   hn::MulAdd(j[0][kDiscPairs.first[K]], j[0][kDiscPairs.second[K]], products[K]))),
   ...);
  ((gradient[P] = hn::MulAdd(j[1][P], e[1], hn::MulAdd(j[0][P], e[0], gradient[P]))), ...);
}

DiscModel model_of(const DiscFit& fit, float x, float y) {
  constexpr double kRoot = 0.70710678;  // a Gaussian's sigma is 1/sqrt(2) of the erf's scale
  const Ellipse& s = fit.ellipse;
  const double determinant = s.determinant();
  const auto inverse = [&](double v) { return static_cast<float>(v / determinant); };
  const double radius = s.radius();
  return {x,
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
}

template <int kSummed>  // of the products: all or none
void accumulate_disc_of(Window& window, const DiscModel& model, DiscNormal& normal) {
  using D = hn::ScalableTag<float>;
  using V = hn::Vec<D>;
  const D d;
  V products[kDiscProducts];
  V gradient[kDiscUnknowns];
  for (int k = 0; k < kSummed; ++k) products[k] = hn::Zero(d);
  for (V& g : gradient) g = hn::Zero(d);
  V square = hn::Zero(d);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < window.count; i += kDiscTogether * lanes) {
    V j[kDiscTogether][kDiscUnknowns];
    V e[kDiscTogether];
    for (int k = 0; k < kDiscTogether; ++k) {
      disc_rows(d, window, model, i + k * lanes, j[k], e[k]);
      square = hn::MulAdd(e[k], e[k], square);
    }
    add_disc(j, e, products, gradient, std::make_index_sequence<kSummed>(),
             std::make_index_sequence<kDiscUnknowns>());
  }
  sums_of_lanes(d, products, kSummed, normal.products);
  sums_of_lanes(d, gradient, kDiscUnknowns, normal.gradient);
  normal.square = hn::GetLane(hn::SumOfLanes(d, square));
}

void accumulate_disc(Window& window, const DiscFit& fit, float x, float y, DiscSums sums,
                     DiscNormal& normal) {
  const DiscModel model = model_of(fit, x, y);
  return sums == DiscSums::kGradient ? accumulate_disc_of<0>(window, model, normal)
                                     : accumulate_disc_of<kDiscProducts>(window, model, normal);
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

namespace {

HWY_EXPORT(accumulate_disc);

}  // namespace

void accumulate_disc(Window& window, const DiscFit& fit, float x, float y, DiscSums sums,
                     DiscNormal& normal) noexcept {
  HWY_DYNAMIC_DISPATCH(accumulate_disc)(window, fit, x, y, sums, normal);
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
