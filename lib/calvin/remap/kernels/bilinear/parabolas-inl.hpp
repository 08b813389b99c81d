// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The parabolas of runs in fixed point, a vector of runs at a time: 32-bit numbers, one per run.
// Compiled once per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_PARABOLAS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_PARABOLAS_INL_HPP
#undef CALVIN_REMAP_PARABOLAS_INL_HPP
#else
#define CALVIN_REMAP_PARABOLAS_INL_HPP
#endif

#include "calvin/remap/kernels/bilinear/vector_layout-inl.hpp"
#include "calvin/remap/map/runs.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Half a row of the source, in 1/2^14.
constexpr std::int32_t kHalfRow = 1 << (kCoordBits - 1);

// Rows of the source that a run may read: 4.12 reaches over 16 rows.
constexpr std::int32_t kMaxSourceRows = 15;

// Where a run takes three rows, y is counted from the middle one and shifted left by this: 1.15.
// (Not where pixels have addresses of their own.)
constexpr int kThreeShift = 3;
// The largest slope down a run, 2.14, that eight times as large still fits into 16 bits: a little
// less than 0x7FFF / 8.
constexpr std::int32_t kMaxSlopeDown = 0x0F00;

// The middle of each run and the differences to its neighbours, 1/2^14 of a sample.
struct RunDifferences {
  hn::Vec<Ints> middle;
  hn::Vec<Ints> across;  // from the middle of the run before to the middle of the run behind
  hn::Vec<Ints> second;  // the second difference of these three middles
};

// `middles` are the middles of two runs before, of the run, and of two runs behind.
template <bool kThird>
HWY_INLINE RunDifferences differences_at(const std::int32_t* middles) {
  const Ints d;
  const auto before = hn::LoadU(d, middles + 1);
  const auto middle = hn::LoadU(d, middles + 2);
  const auto after = hn::LoadU(d, middles + 3);
  auto across = after - before;
  if constexpr (kThird) {
    const auto third = hn::LoadU(d, middles + 4) - hn::Load(d, middles) - across - across;
    across = across - hn::ShiftRight<8>(third * hn::Set(d, kThirdPart));
  }
  return {middle, across, before + after - middle - middle};
}

// The parabola of each run along one axis.
struct AxisParabola {
  hn::Vec<Ints> middle;  // 1/2^14 of a sample
  hn::Vec<Ints> slope;   // per sample of the output, 2.14
  hn::Vec<Ints> bend;    // what the parabola adds at the ends of the run, 4.12
};

template <int kRun>
HWY_INLINE AxisParabola parabola_of(const RunDifferences& differences) {
  // The ends are (kRun - 1) / 2 samples from the middle, the parabola's second coefficient is
  // second / (2 kRun^2), and 2^14 becomes 2^12: for eight samples the bend is second * 49 / 2^11,
  // for four second * 9 / 2^9. The slope is across / (2 kRun).
  constexpr int kFactor = kRun == 8 ? 49 : 9;
  constexpr int kShift = kRun == 8 ? 11 : 9;
  constexpr int kSlopeShift = kRun == 8 ? 4 : kRun == 4 ? 3 : 2;
  const auto slope = hn::ShiftRight<kSlopeShift>(differences.across);
  // Two samples lie on a line; the parabola at half a sample is second / 2^5 off its middle.
  if constexpr (kRun == 2) {
    return {differences.middle + hn::ShiftRight<5>(differences.second), slope, hn::Zero(Ints())};
  }
  return {differences.middle, slope,
          hn::ShiftRight<kShift>(differences.second * hn::Set(Ints(), kFactor))};
}

// A bound of the distance from the middle of a run to its ends, 1/2^14 of a sample.
template <int kRun>
HWY_INLINE hn::Vec<Ints> half_of(const AxisParabola& parabola) {
  const auto abs_slope = hn::Abs(parabola.slope);
  // (kRun - 1) / 2 slopes from the middle to the ends.
  auto half = hn::ShiftRight<1>(abs_slope) + hn::Set(Ints(), 16);
  if constexpr (kRun == 4) half = half + abs_slope;
  if constexpr (kRun == 8) half = half + hn::ShiftLeft<1>(abs_slope) + abs_slope;
  if constexpr (kRun > 2) half = half + hn::ShiftLeft<2>(hn::Abs(parabola.bend));
  return half;
}

// As half_of(), from the middle of the run to the first column of its part `kPart`: negative where
// that column is behind the middle.
template <class P, int kPart>
HWY_INLINE hn::Vec<Ints> part_half(const AxisParabola& parabola) {
  const Ints d;
  const auto all = half_of<P::kRun>(parabola);
  if constexpr (P::kParts == 1) return all;
  constexpr int kFirst = 2 * kPart * P::kRun / P::kParts - reach(P::kRun);
  constexpr int kLast = kFirst + 2 * (P::kRun / P::kParts - 1);
  const auto at = [&](int halves) HWY_ATTR {
    const int square = (4 << 12) * halves * halves / (reach(P::kRun) * reach(P::kRun));
    return hn::ShiftRight<1>(parabola.slope * hn::Set(d, halves)) +
           hn::ShiftRight<12>(parabola.bend * hn::Set(d, square));
  };
  // 1/64 of a sample for rounding, and for a parabola that is bent between the part's ends.
  const auto slack = hn::Set(d, 256);
  return hn::Min(all, slack - hn::Min(at(kFirst), at(kLast)));
}

// Records of two 16-bit numbers; the high one comes in the upper half of its 32 bits.
HWY_INLINE hn::Vec<Ints> packed(hn::Vec<Ints> low, hn::Vec<Ints> high_shifted) {
  const Ints d;
  const hn::Repartition<std::int16_t, Ints> halves;
  return hn::BitCast(d, hn::OddEven(hn::BitCast(halves, high_shifted), hn::BitCast(halves, low)));
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
