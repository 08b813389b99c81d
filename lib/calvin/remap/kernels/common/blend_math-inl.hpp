// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The arithmetic that all bilinear kernels for 8-bit samples share, for vectors of any size.
// Compiled once per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_BLEND_MATH_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_BLEND_MATH_INL_HPP
#undef CALVIN_REMAP_BLEND_MATH_INL_HPP
#else
#define CALVIN_REMAP_BLEND_MATH_INL_HPP
#endif

#include "calvin/remap/kernels/common/vectors-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Keeps a constant in its register. Compilers make constants anew at every use, on the port that
// shuffles need; a value that comes out of inline assembly is none for them.
template <class V>
HWY_INLINE V in_register(V v) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG)
  asm("" : "+v"(v.raw));
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3 && HWY_COMPILER_GCC && !HWY_COMPILER_CLANG
  asm("" : "+x"(v.raw));
#endif
  return v;
}

// Rounds to the nearest integer; the numbers must fit into 32 bits (NearestInt() also handles
// others).
HWY_INLINE hn::Vec<Ints> small_ints(hn::Vec<Floats> v) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  return hn::Vec<Ints>{_mm512_cvtps_epi32(v.raw)};
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  return hn::Vec<Ints>{_mm256_cvtps_epi32(v.raw)};
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
  return hn::Vec<Ints>{_mm_cvtps_epi32(v.raw)};
#else
  return hn::NearestInt(v);
#endif
}

// The tag of 16-bit numbers for a vector as large as one of bytes with the tag D.
template <class D>
using NumbersOf = hn::RepartitionToWide<hn::RebindToSigned<D>>;

// Highway 1.0.3 has no multiplication of unsigned by signed bytes that adds up pairs, and no
// packing of two vectors. N is the vector of results.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
#undef CALVIN_REMAP_HAS_PRODUCTS
#define CALVIN_REMAP_HAS_PRODUCTS 1
template <class D, class V = hn::Vec<D>, class N = hn::Vec<NumbersOf<D>>>
HWY_INLINE N add_products(D /*d*/, V pairs, V weights) {
  if constexpr (sizeof(V) == 16) return N{_mm_maddubs_epi16(pairs.raw, weights.raw)};
#if HWY_TARGET <= HWY_AVX2
  if constexpr (sizeof(V) == 32) return N{_mm256_maddubs_epi16(pairs.raw, weights.raw)};
#endif
#if HWY_TARGET <= HWY_AVX3
  if constexpr (sizeof(V) == 64) return N{_mm512_maddubs_epi16(pairs.raw, weights.raw)};
#endif
}

// Multiplies 16-bit numbers, and adds up the products of each pair.
template <class D, class V = hn::Vec<D>, class N = hn::Vec<hn::RepartitionToWide<D>>>
HWY_INLINE N add_word_products(D /*d*/, V a, V b) {
  if constexpr (sizeof(V) == 16) return N{_mm_madd_epi16(a.raw, b.raw)};
#if HWY_TARGET <= HWY_AVX2
  if constexpr (sizeof(V) == 32) return N{_mm256_madd_epi16(a.raw, b.raw)};
#endif
#if HWY_TARGET <= HWY_AVX3
  if constexpr (sizeof(V) == 64) return N{_mm512_madd_epi16(a.raw, b.raw)};
#endif
}

// Packs 16-bit numbers into bytes: by lane, those of `first` and then those of `second`.
template <class D, class N = hn::Vec<NumbersOf<D>>, class V = hn::Vec<D>>
HWY_INLINE V pack_lanes(D /*d*/, N first, N second) {
  if constexpr (sizeof(V) == 16) return V{_mm_packus_epi16(first.raw, second.raw)};
#if HWY_TARGET <= HWY_AVX2
  if constexpr (sizeof(V) == 32) return V{_mm256_packus_epi16(first.raw, second.raw)};
#endif
#if HWY_TARGET <= HWY_AVX3
  if constexpr (sizeof(V) == 64) return V{_mm512_packus_epi16(first.raw, second.raw)};
#endif
}
#else
#undef CALVIN_REMAP_HAS_PRODUCTS
#define CALVIN_REMAP_HAS_PRODUCTS 0

template <class D, class V = hn::Vec<D>, class N = hn::Vec<hn::RepartitionToWide<D>>>
HWY_INLINE N add_word_products(D /*d*/, V a, V b) {
  const hn::RepartitionToWide<D> ints;
  const auto low = [&](V v) HWY_ATTR {
    return hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(ints, v)));
  };
  const auto high = [&](V v) HWY_ATTR { return hn::ShiftRight<16>(hn::BitCast(ints, v)); };
  return low(a) * low(b) + high(a) * high(b);
}

template <class D, class N = hn::Vec<NumbersOf<D>>>
HWY_INLINE hn::Vec<D> pack_lanes(D d, N first, N second) {
  static_assert(hn::MaxLanes(D()) <= 16);
  const hn::Half<D> half;
  return hn::Combine(d, hn::DemoteTo(half, second), hn::DemoteTo(half, first));
}
#endif

// Blends pairs of neighbours, which are two bytes next to each other in a vector.
template <class D>
class Blender {
 public:
  using Pairs = hn::Vec<D>;
  using Numbers = hn::Vec<NumbersOf<D>>;

  HWY_INLINE Blender()
      : sum_(in_register(hn::BitCast(D(), hn::Set(NumbersOf<D>(), 0x4040)))),
        difference_(in_register(hn::BitCast(D(), hn::Set(NumbersOf<D>(), 0x40C0)))),
        to_bytes_(in_register(hn::Set(NumbersOf<D>(), 256))) {}

  using Sums = Numbers;

  // 128 times the values between neighbours. `across` is twice the weight of the right one, less 1;
  // 1.15. With w that weight, 128 (a + w (b - a)) = 64 (a + b) + 64 (b - a) (2 w - 1).
  [[nodiscard]] HWY_INLINE Numbers across(Pairs pairs, Numbers across) const {
#if CALVIN_REMAP_HAS_PRODUCTS
    // The factors are 64 and 64 for the sum, -64 and 64 for the difference.
    const Numbers sum = add_products(D(), pairs, sum_);
    const Numbers difference = add_products(D(), pairs, difference_);
#else
    const hn::RebindToUnsigned<NumbersOf<D>> d;
    const NumbersOf<D> numbers;
    const auto words = hn::BitCast(d, pairs);
    const auto first = hn::BitCast(numbers, hn::And(words, hn::Set(d, 0xFF)));
    const auto second = hn::BitCast(numbers, hn::ShiftRight<8>(words));
    const Numbers sum = hn::ShiftLeft<6>(first + second);
    const Numbers difference = hn::ShiftLeft<6>(second - first);
#endif
    return sum + hn::MulFixedPoint15(difference, across);
  }

  // The value between two; `weight` is that of the second one, 1.15.
  [[nodiscard]] static HWY_INLINE Numbers between(Numbers first, Numbers second, Numbers weight) {
    return first + hn::MulFixedPoint15(second - first, weight);
  }

  // 128 times values -> values.
  [[nodiscard]] HWY_INLINE Numbers rounded(Numbers numbers) const {
    return hn::MulFixedPoint15(numbers, to_bytes_);
  }

  // Two vectors of 128 times values -> bytes, packed lane by lane.
  [[nodiscard]] HWY_INLINE Pairs pack(Numbers first, Numbers second) const {
    return pack_lanes(D(), rounded(first), rounded(second));
  }

 private:
  Pairs sum_;
  Pairs difference_;
  Numbers to_bytes_;
};

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
