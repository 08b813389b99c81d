// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// DoubleVec: several doubles at once, as many as the processor adds in one instruction, with the
// operators of a double; and the functions that a formula needs for either. A formula written over
// `typename T` is thus one text for a point and for a vector of points.
//
// Compiled once per target of Highway, as its own *-inl.h: include it after hwy/foreach_target.h in
// a file that has that (vector_targets.hpp before it), and plainly elsewhere. A comparison of
// DoubleVecs gives a Mask, one of doubles a bool; MaskOf<T> is either. No branch may depend on a
// mask: compute both sides and select().
#if defined(CALVIN_CAMERA_DOUBLE_VEC_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_DOUBLE_VEC_INL_HPP
#undef CALVIN_CAMERA_DOUBLE_VEC_INL_HPP
#else
#define CALVIN_CAMERA_DOUBLE_VEC_INL_HPP
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calvin/core/vector_targets.hpp"
// After vector_targets.hpp.
#include <hwy/highway.h>
// After highway.h.
#include <hwy/contrib/math/math-inl.h>

#if HWY_HAVE_SCALABLE
#error "Include calvin/core/vector_targets.hpp before the headers of Highway."
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

namespace hn = ::hwy::HWY_NAMESPACE;

// One truth value per lane.
struct Mask {
  using Tag = hn::CappedTag<double, 8>;
  hn::Mask<Tag> raw;
};

// The operators are no friends: gcc 12 compiles a friend that is defined in its class without the
// instructions of the target, so that it takes vectors from elsewhere than its callers put them.
// Where nothing is optimised, and so nothing is inlined, that crashes.
HWY_INLINE Mask operator&(Mask a, Mask b) { return {hn::And(a.raw, b.raw)}; }
HWY_INLINE Mask operator|(Mask a, Mask b) { return {hn::Or(a.raw, b.raw)}; }
HWY_INLINE Mask operator!(Mask a) { return {hn::Not(a.raw)}; }

struct DoubleVec {
  using Tag = Mask::Tag;
  static constexpr std::size_t kSize = hn::MaxLanes(Tag());
  hn::Vec<Tag> raw;

  DoubleVec() = default;
  HWY_INLINE DoubleVec(double x) : raw(hn::Set(Tag(), x)) {}  // NOLINT(google-explicit-constructor)
  HWY_INLINE explicit DoubleVec(hn::Vec<Tag> v) : raw(v) {}

  // kSize doubles; the address is a multiple of kSize * sizeof(double).
  static HWY_INLINE DoubleVec load(const double* from) { return DoubleVec(hn::Load(Tag(), from)); }
  HWY_INLINE void store(double* to) const { hn::Store(raw, Tag(), to); }
};

HWY_INLINE DoubleVec operator+(DoubleVec a, DoubleVec b) {
  return DoubleVec(hn::Add(a.raw, b.raw));
}
HWY_INLINE DoubleVec operator-(DoubleVec a, DoubleVec b) {
  return DoubleVec(hn::Sub(a.raw, b.raw));
}
HWY_INLINE DoubleVec operator*(DoubleVec a, DoubleVec b) {
  return DoubleVec(hn::Mul(a.raw, b.raw));
}
HWY_INLINE DoubleVec operator/(DoubleVec a, DoubleVec b) {
  return DoubleVec(hn::Div(a.raw, b.raw));
}
HWY_INLINE DoubleVec operator-(DoubleVec a) { return DoubleVec(hn::Neg(a.raw)); }
HWY_INLINE DoubleVec& operator+=(DoubleVec& a, DoubleVec b) { return a = a + b; }
HWY_INLINE DoubleVec& operator-=(DoubleVec& a, DoubleVec b) { return a = a - b; }
HWY_INLINE DoubleVec& operator*=(DoubleVec& a, DoubleVec b) { return a = a * b; }

HWY_INLINE Mask operator<(DoubleVec a, DoubleVec b) { return {hn::Lt(a.raw, b.raw)}; }
HWY_INLINE Mask operator<=(DoubleVec a, DoubleVec b) { return {hn::Le(a.raw, b.raw)}; }
HWY_INLINE Mask operator>(DoubleVec a, DoubleVec b) { return {hn::Gt(a.raw, b.raw)}; }
HWY_INLINE Mask operator>=(DoubleVec a, DoubleVec b) { return {hn::Ge(a.raw, b.raw)}; }

template <typename T>
struct MaskType;
template <>
struct MaskType<double> {
  using Type = bool;
};
template <>
struct MaskType<DoubleVec> {
  using Type = Mask;
};
template <typename T>
using MaskOf = typename MaskType<T>::Type;

HWY_INLINE double sqrt(double x) { return std::sqrt(x); }
HWY_INLINE double abs(double x) { return std::abs(x); }
HWY_INLINE double min(double a, double b) { return std::min(a, b); }
HWY_INLINE double max(double a, double b) { return std::max(a, b); }
HWY_INLINE double select(bool where, double a, double b) { return where ? a : b; }
HWY_INLINE bool all_true(bool mask) { return mask; }

HWY_INLINE DoubleVec sqrt(DoubleVec x) { return DoubleVec(hn::Sqrt(x.raw)); }
HWY_INLINE DoubleVec abs(DoubleVec x) { return DoubleVec(hn::Abs(x.raw)); }
HWY_INLINE DoubleVec min(DoubleVec a, DoubleVec b) { return DoubleVec(hn::Min(a.raw, b.raw)); }
HWY_INLINE DoubleVec max(DoubleVec a, DoubleVec b) { return DoubleVec(hn::Max(a.raw, b.raw)); }
HWY_INLINE DoubleVec select(Mask where, DoubleVec a, DoubleVec b) {
  return DoubleVec(hn::IfThenElse(where.raw, a.raw, b.raw));
}
HWY_INLINE bool all_true(Mask mask) { return hn::AllTrue(Mask::Tag(), mask.raw); }

// The angle of (x, y) for y >= 0, 0 to pi rad, to 4 ulp; 0 at the origin.
HWY_INLINE double atan2(double y, double x) { return std::atan2(y, x); }
HWY_INLINE DoubleVec atan2(DoubleVec y, DoubleVec x) {
  const DoubleVec across = abs(x);
  const DoubleVec acute = DoubleVec(hn::Atan(DoubleVec::Tag(), (y / across).raw));
  return select(y > 0, select(x < 0, std::numbers::pi - acute, acute),
                select(x < 0, std::numbers::pi, 0));
}

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_DOUBLE_VEC_INL_HPP
