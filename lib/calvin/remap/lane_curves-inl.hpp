// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What describes runs: vectors of 32-bit numbers, one per run. Compiled once per target of Highway:
// include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_LANE_CURVES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_LANE_CURVES_INL_HPP
#undef CALVIN_REMAP_LANE_CURVES_INL_HPP
#else
#define CALVIN_REMAP_LANE_CURVES_INL_HPP
#endif

#include "calvin/remap/lane_placing-inl.hpp"
#include "calvin/remap/runs.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Half a row of the source, as places are counted.
constexpr std::int32_t kHalfRow = 1 << (kPlaceBits - 1);

// Places of 4.12 reach over 16 rows.
constexpr std::int32_t kMostRows = 15;

// Of three rows, unless pixels are apart, y is counted from the middle one, and is larger by that.
constexpr int kThreeShift = 3;
// A slope down that still is 2.14 then.
constexpr std::int32_t kSteepest = 0x0F00;

// What a parabola through the middles of runs is made of, one per run.
struct Curve {
  hn::Vec<Ints> middle;
  hn::Vec<Ints> across;  // from the run before to the one behind
  hn::Vec<Ints> second;  // difference
};

// `places` of two runs before, of the run, and of two behind.
template <bool kThird>
HWY_INLINE Curve curve_at(const std::int32_t* places) {
  const Ints d;
  const auto before = hn::LoadU(d, places + 1);
  const auto middle = hn::LoadU(d, places + 2);
  const auto after = hn::LoadU(d, places + 3);
  auto across = after - before;
  if constexpr (kThird) {
    const auto third = hn::LoadU(d, places + 4) - hn::Load(d, places) - across - across;
    across = across - hn::ShiftRight<8>(third * hn::Set(d, kThirdPart));
  }
  return {middle, across, before + after - middle - middle};
}

// What a run needs of an axis.
struct Line {
  hn::Vec<Ints> middle;
  hn::Vec<Ints> slope;  // 2.14
  hn::Vec<Ints> bend;   // 4.12
};

template <int kRun>
HWY_INLINE Line line_of(const Curve& curve) {
  // Second difference -> what the parabola adds at the ends, and half of the width for the slope.
  constexpr int kFactor = kRun == 8 ? 49 : 9;
  constexpr int kShift = kRun == 8 ? 11 : 9;
  constexpr int kSlopeShift = kRun == 8 ? 4 : kRun == 4 ? 3 : 2;
  const auto slope = hn::ShiftRight<kSlopeShift>(curve.across);
  // Two samples lie on a line, beside the parabola's middle.
  if constexpr (kRun == 2) {
    return {curve.middle + hn::ShiftRight<5>(curve.second), slope, hn::Zero(Ints())};
  }
  return {curve.middle, slope, hn::ShiftRight<kShift>(curve.second * hn::Set(Ints(), kFactor))};
}

// What the places of a run are away from its middle at most, and a little.
template <int kRun>
HWY_INLINE hn::Vec<Ints> half_of(const Line& line) {
  const auto steep = hn::Abs(line.slope);
  // (kRun - 1) / 2 slopes from the middle to the ends.
  auto half = hn::ShiftRight<1>(steep) + hn::Set(Ints(), 16);
  if constexpr (kRun == 4) half = half + steep;
  if constexpr (kRun == 8) half = half + hn::ShiftLeft<1>(steep) + steep;
  if constexpr (kRun > 2) half = half + hn::ShiftLeft<2>(hn::Abs(line.bend));
  return half;
}

// The same of a part of a run, to its first column: it is negative where that is behind the middle.
template <class P, int kPart>
HWY_INLINE hn::Vec<Ints> part_half(const Line& line) {
  const Ints d;
  const auto all = half_of<P::kRun>(line);
  if constexpr (P::kParts == 1) return all;
  constexpr int kFirst = 2 * kPart * P::kRun / P::kParts - reach(P::kRun);
  constexpr int kLast = kFirst + 2 * (P::kRun / P::kParts - 1);
  const auto at = [&](int halves) HWY_ATTR {
    const int square = (4 << 12) * halves * halves / (reach(P::kRun) * reach(P::kRun));
    return hn::ShiftRight<1>(line.slope * hn::Set(d, halves)) +
           hn::ShiftRight<12>(line.bend * hn::Set(d, square));
  };
  // Rounding, and what the parabola is bent between the ends.
  const auto slack = hn::Set(d, 256);
  return hn::Min(all, slack - hn::Min(at(kFirst), at(kLast)));
}

// Two 16-bit numbers in 32 bits.
HWY_INLINE hn::Vec<Ints> packed(hn::Vec<Ints> low, hn::Vec<Ints> high_shifted) {
  const Ints d;
  const hn::Repartition<std::int16_t, Ints> halves;
  return hn::BitCast(d, hn::OddEven(hn::BitCast(halves, high_shifted), hn::BitCast(halves, low)));
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
