// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// As Blender of remap/kernels/common/blend_math-inl.hpp, for samples of 16 bits: a result takes 32
// bits. Compiled once per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_WORD_MATH_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_WORD_MATH_INL_HPP
#undef CALVIN_REMAP_WORD_MATH_INL_HPP
#else
#define CALVIN_REMAP_WORD_MATH_INL_HPP
#endif

#include "calvin/remap/kernels/common/blend_math-inl.hpp"
#include "calvin/remap/kernels/common/pixel_layout.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Packs 32-bit numbers into 16 bits: by lane, those of `first` and then those of `second`.
HWY_INLINE Numbers pack_word_lanes(hn::Vec<Ints> first, hn::Vec<Ints> second) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  return Numbers{_mm512_packs_epi32(first.raw, second.raw)};
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  return Numbers{_mm256_packs_epi32(first.raw, second.raw)};
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
  return Numbers{_mm_packs_epi32(first.raw, second.raw)};
#else
  static_assert(kLanes == 1);
  const hn::Half<Signed> half;
  return hn::Combine(Signed(), hn::DemoteTo(half, second), hn::DemoteTo(half, first));
#endif
}

// Blends pairs of neighbours, which are two 16-bit samples next to each other in a vector; the
// value between them takes their 32 bits. The weights of a sample come twice, once for each half.
class WordBlender {
 public:
  using Sums = hn::Vec<Ints>;

  HWY_INLINE explicit WordBlender(WordFormat format)
      : turn_(hn::BitCast(Signed(), hn::Set(Ints(), 0x2000E000))),
        half_(hn::Set(Signed(), 0x2000)),
        sign_(hn::BitCast(Signed(), hn::Set(Words(), 0x8000))),
        rounding_(hn::Set(Ints(), 1 << (kBits - 1 + format.shift))),
        format_(format) {}

  // 2^14 times the values between neighbours, each less 2^15; `across` as in Blender::across().
  [[nodiscard]] HWY_INLINE Sums across(Pairs pairs, Numbers across) const {
    // The weights are 2^13 (1 - across) for the left one and 2^13 (1 + across) for the right one.
    const Numbers weights = hn::MulFixedPoint15(across, turn_) + half_;
    return add_word_products(Signed(), hn::Xor(hn::BitCast(Signed(), pairs), sign_), weights);
  }

  // The value between two; `weight` is that of the second one, 1.15.
  [[nodiscard]] static HWY_INLINE Sums between(Sums first, Sums second, Numbers weight) {
    const Floats d;
    const auto part = hn::ConvertTo(d, hn::ShiftRight<16>(hn::BitCast(Ints(), weight)));
    const auto difference = hn::ConvertTo(d, second - first);
    return first + small_ints(difference * (part * hn::Set(d, 1.0F / 32768)));
  }

  // Two vectors of sums -> samples as they are in memory, packed lane by lane.
  [[nodiscard]] HWY_INLINE Pairs pack(Sums first, Sums second) const {
    const auto value = [&](Sums sum) HWY_ATTR {
      const auto whole = hn::ShiftRightSame(sum + rounding_, kBits + format_.shift);
      return hn::ShiftLeftSame(whole, format_.shift);
    };
    const auto words =
        hn::BitCast(Words(), hn::Xor(pack_word_lanes(value(first), value(second)), sign_));
    if (!format_.swapped) return hn::BitCast(Bytes(), words);
    return hn::BitCast(Bytes(), hn::Or(hn::ShiftLeft<8>(words), hn::ShiftRight<8>(words)));
  }

 private:
  static constexpr int kBits = 14;

  Numbers turn_;
  Numbers half_;
  Numbers sign_;
  hn::Vec<Ints> rounding_;
  WordFormat format_;
};

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
