// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The error function, what a Gaussian blur makes of an edge, a vector at a time. Included once for
// each of Highway's targets.
#if defined(CALVIN_DETECT_ERROR_FUNCTION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_DETECT_ERROR_FUNCTION_INL
#undef CALVIN_DETECT_ERROR_FUNCTION_INL
#else
#define CALVIN_DETECT_ERROR_FUNCTION_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// erf(x) = 1 - 1 / p(x)^4 for x > 0, within 5e-4: Abramowitz and Stegun, 7.1.27.
template <class V>
struct ErrorFunction {
  V p;
  V slope;  // of p

  template <class D>
  HWY_INLINE ErrorFunction(D d, V x) {
    const auto set = [&](float v) { return hn::Set(d, v); };
    const V t = hn::Min(hn::Abs(x), set(4.0F));
    p = hn::MulAdd(set(0.078108F), t, set(0.000972F));
    p = hn::MulAdd(p, t, set(0.230389F));
    p = hn::MulAdd(p, t, set(0.278393F));
    p = hn::MulAdd(p, t, set(1));
    slope = hn::MulAdd(set(4 * 0.078108F), t, set(3 * 0.000972F));
    slope = hn::MulAdd(slope, t, set(2 * 0.230389F));
    slope = hn::MulAdd(slope, t, set(0.278393F));
  }
  // `inverse`: 1 / p.
  template <class D>
  HWY_INLINE V value(D d, V x, V inverse, V& derivative) const {
    const V square = hn::Mul(inverse, inverse);
    const V fourth = hn::Mul(square, square);
    derivative = hn::Mul(hn::Mul(hn::Set(d, 4), slope), hn::Mul(fourth, inverse));
    return hn::CopySign(hn::Sub(hn::Set(d, 1), fourth), x);
  }
};

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // once for each target
