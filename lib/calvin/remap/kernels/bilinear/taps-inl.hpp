// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Blends a vector of results from the taps in three rows of the source, or in more. Compiled once
// per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_TAPS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_TAPS_INL_HPP
#undef CALVIN_REMAP_TAPS_INL_HPP
#else
#define CALVIN_REMAP_TAPS_INL_HPP
#endif

#include "calvin/remap/kernels/bilinear/memory_layout-inl.hpp"
#include "calvin/remap/kernels/common/blend_math-inl.hpp"
#include "calvin/remap/kernels/common/run_row.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// The bytes of the source that a vector of results is blended from, and their weights.
struct Taps {
  Pairs neighbours;  // byte indices, from the beginning of the segment
  Numbers across;    // twice the weight of the right one of two neighbours, less 1; 1.15
  Numbers down;      // y as in RunRow::middle
};

// Blends two rows that are blended across already; `weight` is that of the second one, 1.15.
template <bool kNearest, class B>
HWY_INLINE typename B::Sums blend_down(const B& blender, typename B::Sums first,
                                       typename B::Sums second, Numbers weight) {
  if constexpr (!kNearest) return blender.between(first, second, weight);
  const Signed d;
  const hn::DFromV<typename B::Sums> sums;
  const auto behind = hn::Gt(weight, hn::Set(d, 0x3FFF));
  return hn::BitCast(sums, hn::IfThenElse(behind, hn::BitCast(d, second), hn::BitCast(d, first)));
}

// With three source rows a result lies between the middle one and one of the other two, which the
// sign of taps.down tells.
template <class L, bool kNearest>
HWY_INLINE auto blend_three_rows(const std::uint8_t* source, const std::int32_t* offsets,
                                 std::int32_t stride, const Taps& taps,
                                 const BlenderOf<L>& blender) {
  const Bytes bytes;
  const Signed d;
  const std::uint8_t* second = source + stride;
  const auto above = hn::BitCast(d, fetch_pairs<L>(source, offsets, taps.neighbours));
  const auto below = hn::BitCast(d, fetch_pairs<L>(second + stride, offsets, taps.neighbours));
  const auto outer = hn::IfVecThenElse(hn::BroadcastSignBit(taps.down), above, below);
  return blend_down<kNearest>(
      blender, blender.across(fetch_pairs<L>(second, offsets, taps.neighbours), taps.across),
      blender.across(hn::BitCast(bytes, outer), taps.across), hn::Abs(taps.down));
}

// With more rows a result lies between two rows next to each other, which are selected first.
template <class L, bool kNearest>
HWY_INLINE auto blend_more_rows(const std::uint8_t* source, const std::int32_t* offsets,
                                std::int32_t stride, std::int32_t rows, const Taps& taps,
                                const BlenderOf<L>& blender) {
  const Words words;
  const Signed d;
  const auto fetch = [&]() HWY_ATTR {
    const Pairs pairs = fetch_pairs<L>(source, offsets, taps.neighbours);
    source += stride;
    return hn::BitCast(d, pairs);
  };
  // 4.12 needs all 16 bits: with the highest one turned over, signed comparisons work.
  const auto down = hn::BitCast(words, taps.down);
  const auto coord = hn::BitCast(d, hn::Xor(down, hn::Set(words, 0x8000)));
  const auto row = hn::Set(d, 4096);
  Numbers upper = fetch();
  Numbers lower = fetch();
  Numbers last = lower;
  Numbers before = hn::Set(d, -0x7001);  // larger coordinates lie behind the second row
  for (std::int32_t r = 2; r < rows; ++r) {
    const Numbers next = fetch();
    const auto behind = hn::Gt(coord, before);
    upper = hn::IfThenElse(behind, last, upper);
    lower = hn::IfThenElse(behind, next, lower);
    last = next;
    before = before + row;
  }
  const auto weight = hn::BitCast(d, hn::And(hn::ShiftLeft<3>(down), hn::Set(words, 0x7FF8)));
  const Bytes bytes;
  return blend_down<kNearest>(blender, blender.across(hn::BitCast(bytes, upper), taps.across),
                              blender.across(hn::BitCast(bytes, lower), taps.across), weight);
}

// Blends a vector of results; it has as many rows as the run `j`. The result is the blender's Sums.
template <class L, bool kThree, bool kNearest>
HWY_INLINE auto blend_rows(const RunRow& row, int j, const std::int32_t* offsets, const Taps& taps,
                           const std::uint8_t* source, std::int32_t stride,
                           const BlenderOf<L>& blender) {
  if constexpr (kThree) {
    return blend_three_rows<L, kNearest>(source, offsets, stride, taps, blender);
  } else {
    return blend_more_rows<L, kNearest>(source, offsets, stride, source_rows(row.marks[j]), taps,
                                        blender);
  }
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
