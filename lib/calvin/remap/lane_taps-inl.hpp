// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A vector of results from three rows of the source or more. Compiled once per target of Highway:
// include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_LANE_TAPS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_LANE_TAPS_INL_HPP
#undef CALVIN_REMAP_LANE_TAPS_INL_HPP
#else
#define CALVIN_REMAP_LANE_TAPS_INL_HPP
#endif

#include "calvin/remap/lane_layouts-inl.hpp"
#include "calvin/remap/lane_math-inl.hpp"
#include "calvin/remap/run_row.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// What a vector of results takes from the source.
struct Taps {
  Pairs neighbours;  // which bytes, from the beginning of the segment
  Numbers across;    // twice the weight of the second of two neighbours, less 1; 1.15
  Numbers down;      // as in RunRow
};

// Of two rows that are blended across; `weight` of the second one, 1.15.
template <bool kNearest, class B>
HWY_INLINE typename B::Sums blend_down(const B& blender, typename B::Sums first,
                                       typename B::Sums second, Numbers weight) {
  if constexpr (!kNearest) return blender.between(first, second, weight);
  const Signed d;
  const hn::DFromV<typename B::Sums> sums;
  const auto behind = hn::Gt(weight, hn::Set(d, 0x3FFF));
  return hn::BitCast(sums, hn::IfThenElse(behind, hn::BitCast(d, second), hn::BitCast(d, first)));
}

// Three source rows: a result lies between the middle one and one of the others.
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

// `rows` source rows: a result lies between two of them, which are chosen first.
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
  // 15 bits do not hold the place: as a signed number, 0 is the least.
  const auto down = hn::BitCast(words, taps.down);
  const auto place = hn::BitCast(d, hn::Xor(down, hn::Set(words, 0x8000)));
  const auto row = hn::Set(d, 4096);
  Numbers upper = fetch();
  Numbers lower = fetch();
  Numbers last = lower;
  Numbers before = hn::Set(d, -0x7001);  // what is larger lies behind the second row
  for (std::int32_t r = 2; r < rows; ++r) {
    const Numbers next = fetch();
    const auto behind = hn::Gt(place, before);
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

// A vector of results whose rows and offsets are those of run `j`, as the blender has sums.
template <class L, bool kThree, bool kNearest>
HWY_INLINE auto blend_rows(const RunRow& row, int j, const std::int32_t* offsets, const Taps& taps,
                           const std::uint8_t* source, std::int32_t stride,
                           const BlenderOf<L>& blender) {
  if constexpr (kThree) {
    return blend_three_rows<L, kNearest>(source, offsets, stride, taps, blender);
  } else {
    return blend_more_rows<L, kNearest>(source, offsets, stride, row.rows[j] % kSteadyRows, taps,
                                        blender);
  }
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
