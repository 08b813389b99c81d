// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The saddle that a corner is, of level 0 and contrast 1, and its derivatives, a vector at a time.
// Included once for each of Highway's targets.
#if defined(CALVIN_DETECT_SADDLE_MODEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_DETECT_SADDLE_MODEL_INL
#undef CALVIN_DETECT_SADDLE_MODEL_INL
#else
#define CALVIN_DETECT_SADDLE_MODEL_INL
#endif

#include <algorithm>
#include <cmath>

#include <hwy/highway.h>

#include "calvin/detect/error_function-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The error functions of two numbers, with one inverse.
template <class V>
struct TwoErrors {
  V first, second;
  V first_slope, second_slope;

  template <class D>
  HWY_INLINE TwoErrors(D d, V x, V y) {
    const ErrorFunction<V> error_x(d, x);
    const ErrorFunction<V> error_y(d, y);
    // A step of Newton's makes a quick inverse of at least 8 bits one of twice as many, which is
    // more than the error function has.
    const V product = hn::Mul(error_x.p, error_y.p);
    const V near = hn::ApproximateReciprocal(product);
    const V inverse = hn::Mul(near, hn::NegMulAdd(near, product, hn::Set(d, 2)));
    first = error_x.value(d, x, hn::Mul(inverse, error_y.p), first_slope);
    second = error_y.value(d, y, hn::Mul(inverse, error_x.p), second_slope);
  }
};

// A saddle and its derivatives by a and b, which are the distances from the edges in their widths.
template <class V>
struct Saddle {
  V value;
  V by_a, by_b;
  V width_a, width_b;  // by the widths' logarithms, negative
  V gain;              // by the gain, in px
  V shared;            // by what the edges share of the blur
  V both;              // by a and b, of the product of the edges alone
};

// The edges meet in the corner. What a blur moves across one of them is correlated by `shared` with
// what it moves across the other unless they are perpendicular: a blurred corner is the product of
// the blurred edges and a series in the correlation (Mehler's), of which two terms count.
template <class D, class V>
HWY_INLINE Saddle<V> plain_saddle(D d, V a, V b, V shared) {
  const TwoErrors<V> e(d, a, b);
  Saddle<V> s;
  s.both = hn::Mul(e.first_slope, e.second_slope);
  const V more = hn::Mul(shared, s.both);
  const V half = hn::Set(d, 0.5F);
  const V product = hn::Mul(shared, hn::Mul(a, b));
  const V series = hn::Add(hn::Set(d, 1), product);
  s.value = hn::MulAdd(hn::Mul(half, more), series, hn::Mul(e.first, e.second));
  const V slope_a = hn::NegMulAdd(half, hn::Mul(shared, b), hn::Mul(series, a));
  const V slope_b = hn::NegMulAdd(half, hn::Mul(shared, a), hn::Mul(series, b));
  s.by_a = hn::NegMulAdd(more, slope_a, hn::Mul(e.second, e.first_slope));
  s.by_b = hn::NegMulAdd(more, slope_b, hn::Mul(e.first, e.second_slope));
  s.width_a = hn::Mul(s.by_a, a);
  s.width_b = hn::Mul(s.by_b, b);
  s.gain = hn::Zero(d);
  s.shared = hn::Mul(s.both, hn::Add(half, product));
  return s;
}

// An edge in a sharp picture, of which the blur is mostly that of the pixels: a pixel shows the
// mean over its square. Across an edge that is the longer side of the square as seen along the
// edge, a box, and the shorter one, which is taken together with the blur of the optics.
template <class V>
struct SharpEdge {
  V value;   // the mean of -1 on one side and +1 on the other
  V slope;   // by the distance in units of sqrt(2) widths
  V second;  // likewise, the second derivative

  // `distance` is in px, `wide` is 1 / (sqrt(2) width), and (x, y) the direction of the edge.
  template <class D>
  HWY_INLINE SharpEdge(D d, V distance, float wide, float x, float y) {
    constexpr float kLeastBlur = 0.08F;  // px, so that the fit sees where to go
    const float half = 0.5F * std::max(std::abs(x), std::abs(y));
    const float variance = 0.5F / (wide * wide) - half * half / 3;
    // The box times the Gaussian's scale, as the edge alone has it.
    const float scale = std::sqrt(2 * std::max(variance, kLeastBlur * kLeastBlur));
    const auto set = [&](float v) { return hn::Set(d, v); };
    const V before = hn::Mul(hn::Sub(distance, set(half)), set(1 / scale));
    const V after = hn::Mul(hn::Add(distance, set(half)), set(1 / scale));
    // The integral of erf(t) is t erf(t) + erf'(t) / 2, but for a constant.
    const TwoErrors<V> e(d, before, after);
    const V integral = hn::MulAdd(set(0.5F), hn::Sub(e.second_slope, e.first_slope),
                                  hn::Sub(hn::Mul(after, e.second), hn::Mul(before, e.first)));
    value = hn::Mul(set(0.5F * scale / half), integral);
    slope = hn::Mul(set(0.5F / (half * wide)), hn::Sub(e.second, e.first));
    second =
        hn::Mul(set(0.5F / (half * wide * wide * scale)), hn::Sub(e.second_slope, e.first_slope));
  }
};

// plain_saddle() of a sharp picture, of its distances in px.
template <class D, class V>
HWY_INLINE Saddle<V> sharp_saddle(D d, const SharpEdge<V>& a, const SharpEdge<V>& b, V shared) {
  const V half = hn::Set(d, 0.5F);
  const V seconds = hn::Mul(hn::Mul(hn::Mul(half, half), shared), hn::Mul(a.second, b.second));
  const V share = hn::Mul(half, shared);
  Saddle<V> s;
  s.both = hn::Mul(a.slope, b.slope);
  s.shared = hn::MulAdd(half, s.both, seconds);
  s.value = hn::MulAdd(a.value, b.value, hn::Mul(share, hn::Add(seconds, s.both)));
  s.by_a = hn::MulAdd(a.slope, b.value, hn::Mul(share, hn::Mul(a.second, b.slope)));
  s.by_b = hn::MulAdd(b.slope, a.value, hn::Mul(share, hn::Mul(b.second, a.slope)));
  s.width_a = hn::Neg(hn::Mul(half, hn::Mul(a.second, b.value)));
  s.width_b = hn::Neg(hn::Mul(half, hn::Mul(b.second, a.value)));
  s.gain = hn::Zero(d);
  return s;
}

// The bright squares are larger by `gain` px on each side, or smaller: each of the two that are
// smaller ends |gain| px before the corner. `wide`: 1 / width.
template <class D, class V>
HWY_INLINE Saddle<V> parted_saddle(D d, V a, V b, float gain, V wide_a, V wide_b, V shared) {
  const V one = hn::Set(d, 1);
  const V half = hn::Set(d, 0.5F);
  // With b and the sign exchanged the dark squares are the bright ones.
  const V turn = hn::Set(d, gain > 0 ? -1.0F : 1.0F);
  const V da = hn::Mul(hn::Set(d, std::abs(gain)), wide_a);
  const V db = hn::Mul(hn::Set(d, std::abs(gain)), wide_b);
  const V c = hn::Mul(turn, b);
  const V near_a = hn::Sub(a, da), far_a = hn::Add(a, da);
  const V near_b = hn::Sub(c, db), far_b = hn::Add(c, db);
  const TwoErrors<V> e(d, near_a, far_a);
  const TwoErrors<V> f(d, near_b, far_b);
  const V in_e = hn::Mul(half, hn::Add(one, e.first)),
          out_e = hn::Mul(half, hn::Sub(one, e.second));
  const V in_f = hn::Mul(half, hn::Add(one, f.first)),
          out_f = hn::Mul(half, hn::Sub(one, f.second));
  const V near_slope_a = hn::Mul(e.first_slope, in_f), far_slope_a = hn::Mul(e.second_slope, out_f);
  const V near_slope_b = hn::Mul(f.first_slope, in_e), far_slope_b = hn::Mul(f.second_slope, out_e);
  const V bright = hn::MulAdd(in_e, in_f, hn::Mul(out_e, out_f));
  // Mehler's series for each of the two, see plain_saddle().
  const V near_both = hn::Mul(e.first_slope, f.first_slope);
  const V far_both = hn::Mul(e.second_slope, f.second_slope);
  const V turned = hn::Mul(turn, shared);
  const V near_more = hn::Mul(near_both, hn::MulAdd(hn::Mul(turned, near_a), near_b, one));
  const V far_more = hn::Mul(far_both, hn::MulAdd(hn::Mul(turned, far_a), far_b, one));
  const V quarter = hn::Mul(hn::Set(d, 0.25F), shared);
  const V more_a = hn::Mul(half, hn::MulAdd(near_both, near_a, hn::Mul(far_both, far_a)));
  const V more_b = hn::Mul(half, hn::MulAdd(near_both, near_b, hn::Mul(far_both, far_b)));
  Saddle<V> s;
  s.value = hn::MulAdd(quarter, hn::Add(near_more, far_more),
                       hn::Mul(turn, hn::Sub(hn::Add(bright, bright), one)));
  s.by_a = hn::NegMulAdd(shared, more_a, hn::Mul(turn, hn::Sub(near_slope_a, far_slope_a)));
  s.by_b = hn::NegMulAdd(turned, more_b, hn::Sub(near_slope_b, far_slope_b));
  s.width_a = hn::Mul(turn, hn::Sub(hn::Mul(near_slope_a, near_a), hn::Mul(far_slope_a, far_a)));
  s.width_b = hn::Mul(turn, hn::Sub(hn::Mul(near_slope_b, near_b), hn::Mul(far_slope_b, far_b)));
  s.gain = hn::MulAdd(wide_a, hn::Add(near_slope_a, far_slope_a),
                      hn::Mul(wide_b, hn::Add(near_slope_b, far_slope_b)));
  s.shared = hn::Mul(hn::Set(d, 0.25F), hn::Add(near_both, far_both));
  s.both = hn::Zero(d);
  return s;
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // once for each target
