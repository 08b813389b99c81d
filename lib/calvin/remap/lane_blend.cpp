// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling, many samples at a time, for every instruction set that there is.
//
// A vector is as many 128-bit lanes as the machine has, and a lane eight results: samples that lie
// next to each other in the output. Their places in the source lie next to each other too, so that
// 16 bytes of each source row hold all of them. One byte shuffle fetches the pairs of neighbours,
// one multiplication of pairs blends them across, and two such rows are blended down. The results
// of a run fill one lane, or two or four of them where pixels have several components.
// Everything that differs between memory layouts is in lane_layouts-inl.hpp.

// Ice Lake and Zen 4 permute all bytes of a vector.
#define HWY_WANT_AVX3_DL 1

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"

#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_blend.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_layouts-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every lane is slow.

void blend_row_of(LaneLayout /*layout*/, int /*run*/, const RunRow& /*row*/, int /*begin*/,
                  int /*end*/, std::int32_t /*stride*/, bool /*nearest*/,
                  const PlaneRows& /*planes*/) {}

#else

// Compilers make constants anew at every use, on the port that shuffles need. One that they do not
// know stays in its register.
template <class V>
HWY_INLINE V kept(V v) {
#if HWY_ARCH_X86 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG) && HWY_TARGET <= HWY_AVX3
  asm("" : "+v"(v.raw));
#endif
  return v;
}

struct Constants {
  Places half;       // from fractions to weights
  Places step;       // bytes of a sample, for both neighbours
  Pairs sum;         // of two bytes, times 64
  Pairs difference;  // likewise
  Numbers to_bytes;  // 1/128 for MulFixedPoint15
};
template <class L>
HWY_INLINE Constants make_constants() {
  const Words words;
  return {kept(hn::Set(words, 0x8000)), kept(hn::Set(words, 0x101 * L::kStep * L::kSpread)),
          kept(hn::BitCast(Bytes(), hn::Set(words, 0x4040))),
          kept(hn::BitCast(Bytes(), hn::Set(words, 0x40C0))), kept(hn::Set(Signed(), 256))};
}

// 64 times the sum of the two bytes of each pair, and 64 times the second less the first.
struct Blend {
  Numbers sum;
  Numbers difference;
};
// Highway 1.0.3 has no multiplication of unsigned by signed bytes that adds up pairs.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
HWY_INLINE Numbers add_products(Pairs pairs, Pairs weights) {
#if HWY_TARGET <= HWY_AVX3
  return Numbers{_mm512_maddubs_epi16(pairs.raw, weights.raw)};
#elif HWY_TARGET <= HWY_AVX2
  return Numbers{_mm256_maddubs_epi16(pairs.raw, weights.raw)};
#else
  return Numbers{_mm_maddubs_epi16(pairs.raw, weights.raw)};
#endif
}
HWY_INLINE Blend blend_pairs(Pairs pairs, const Constants& constants) {
  return {add_products(pairs, constants.sum), add_products(pairs, constants.difference)};
}
#else
HWY_INLINE Blend blend_pairs(Pairs pairs, const Constants& /*constants*/) {
  const Words d;
  const auto words = hn::BitCast(d, pairs);
  const auto first = hn::BitCast(Signed(), hn::And(words, hn::Set(d, 0xFF)));
  const auto second = hn::BitCast(Signed(), hn::ShiftRight<8>(words));
  return {hn::ShiftLeft<6>(first + second), hn::ShiftLeft<6>(second - first)};
}
#endif

// What a vector of results takes from the source.
struct Taps {
  Pairs neighbours;  // which bytes, from the beginning of the segment
  Numbers across;    // twice the weight of the second of two neighbours, less 1; 1.15
  // Place down: from the middle one of three rows, 1.15; or from the segment's first row, 4.12.
  Numbers down;
};

// 128 times the values between neighbours of one source row.
HWY_INLINE Numbers blend_row(Pairs pairs, const Taps& taps, const Constants& constants) {
  const Blend blend = blend_pairs(pairs, constants);
  return blend.sum + hn::MulFixedPoint15(blend.difference, taps.across);
}

// Which of 16-bit numbers are negative.
HWY_INLINE auto negative(Numbers numbers) {
#if HWY_TARGET > HWY_AVX3 || !HWY_ARCH_X86
  numbers = hn::BroadcastSignBit(numbers);
#endif
  return hn::MaskFromVec(numbers);
}

// Three source rows: a result lies between the middle one and one of the others.
template <class L, bool kNearest>
HWY_INLINE Numbers blend_three_rows(const std::uint8_t* source, const std::int32_t* offsets,
                                    std::int32_t stride, const Taps& taps,
                                    const Constants& constants) {
  const Bytes bytes;
  const Signed d;
  const std::uint8_t* second = source + stride;
  const auto above = hn::BitCast(d, fetch_pairs<L>(source, offsets, taps.neighbours));
  const auto below = hn::BitCast(d, fetch_pairs<L>(second + stride, offsets, taps.neighbours));
  const auto outer = hn::IfThenElse(negative(taps.down), above, below);
  const Numbers middle =
      blend_row(fetch_pairs<L>(second, offsets, taps.neighbours), taps, constants);
  const Numbers other = blend_row(hn::BitCast(bytes, outer), taps, constants);
  auto weight = hn::Abs(taps.down);
  if constexpr (kNearest) {
    weight = hn::IfThenElseZero(hn::Gt(weight, hn::Set(d, 0x3FFF)), hn::Set(d, 0x7FFF));
  }
  return middle + hn::MulFixedPoint15(other - middle, weight);
}

// `rows` source rows, each result between two of them. Rare, and apart from the others so that
// these keep their registers.
template <class L>
HWY_NOINLINE Numbers blend_more_rows(const std::uint8_t* source, const std::int32_t* offsets,
                                     std::int32_t stride, std::int32_t rows, Taps taps) {
  const Words words;
  const Signed numbers;
  const Constants constants = make_constants<L>();
  // 15 bits do not hold the place.
  const auto row = hn::Set(words, 4096);
  const auto last = hn::Set(words, 4095);
  auto down = hn::BitCast(words, taps.down);
  Numbers upper = blend_row(fetch_pairs<L>(source, offsets, taps.neighbours), taps, constants);
  Numbers sum = upper;
  for (std::int32_t r = 1; r < rows; ++r) {
    source += stride;
    const Numbers lower =
        blend_row(fetch_pairs<L>(source, offsets, taps.neighbours), taps, constants);
    const auto weight = hn::BitCast(numbers, hn::ShiftLeft<3>(hn::Min(down, last)));
    sum = sum + hn::MulFixedPoint15(lower - upper, weight);
    down = hn::SaturatedSub(down, row);
    upper = lower;
  }
  return sum;
}

// The place of each result from its run's segment: across 4.12, down as in Taps.
struct Located {
  Numbers x;
  Numbers y;
};
template <class L>
HWY_INLINE Located locate(const RunRow& row, int run, const std::int32_t* x_lines,
                          const Results& tables) {
  const Bytes bytes;
  const Signed numbers;
  constexpr const Halves& kLines = kByLanes<L> ? kLaneHalves : kHalves<L>;
  const auto low = hn::Load(bytes, kHalves<L>.low);
  const auto high = hn::Load(bytes, kHalves<L>.high);
  const auto along = hn::Load(numbers, tables.along);
  const auto half = [&](Pairs records, Pairs which) HWY_ATTR {
    return hn::BitCast(numbers, hn::TableLookupBytes(records, which));
  };
  const auto records = [&](const std::int32_t* at) HWY_ATTR {
    return hn::LoadDup128(bytes, reinterpret_cast<const std::uint8_t*>(at));
  };
  const Pairs x_line = records(x_lines);
  const Pairs y_line = records(row.y_line + run);
  Located at = {half(x_line, hn::Load(bytes, kLines.low)) +
                    hn::MulFixedPoint15(half(x_line, hn::Load(bytes, kLines.high)), along),
                half(y_line, low) + hn::MulFixedPoint15(half(y_line, high), along)};
  if constexpr (L::kRunPixels > 2) {
    const auto square = hn::Load(numbers, tables.square);
    const Pairs bend = records(row.bend + run);
    at.x = at.x + hn::MulFixedPoint15(half(bend, low), square);
    at.y = at.y + hn::MulFixedPoint15(half(bend, high), square);
  }
  return at;
}

// Rows of the source that are fetched before they are needed: the hardware does not foresee a walk
// along a curve.
constexpr int kAhead = 12;

template <class L, bool kNearest, int kPlanes>
void blend(const RunRow& row, int begin, int end, std::int32_t stride, const PlaneRows& planes) {
  const Words words;
  const Bytes bytes;
  const Signed numbers;
  const Constants constants = make_constants<L>();
  // What is written may be anything for all that the compiler knows.
  std::array<const std::uint8_t*, kPlanes> sources;
  std::array<std::uint8_t*, kPlanes> outputs;
  for (int p = 0; p < kPlanes; ++p) {
    sources[p] = planes.source[p];
    outputs[p] = planes.output[p];
  }
  const auto nearest = [&](Numbers places) HWY_ATTR {
    return hn::And(places + hn::Set(numbers, 2048), hn::BitCast(numbers, hn::Set(words, 0xF000)));
  };
  for (int j = begin; j < end; j += kLanes) {
    const std::int32_t rows = row.rows[j] % kSlowRun;
    if (HWY_UNLIKELY(row.rows[j] >= kSlowGroup)) {
      for (auto& output : outputs) output += L::kSpan * L::kOut;
      continue;
    }
    for (int v = 0; v < L::kSpan; ++v) {
      const int run = j + v * kLanes / L::kSpan;
      const int lane = j * L::kSpan + v * kLanes;
      const Results& tables = kResults<L>[v % L::kParts];
      const std::int32_t* offsets = kByLanes<L> ? row.lane_offset + lane : row.offset + run;
      Located at =
          locate<L>(row, run, kByLanes<L> ? row.lane_line + lane : row.x_line + run, tables);
      if constexpr (kNearest) {
        at.x = nearest(at.x);
        if (rows != 3) at.y = nearest(at.y);
      }
      const auto columns = hn::ShiftRight<12>(hn::BitCast(words, at.x));
      const auto fraction = hn::ShiftLeft<4>(hn::BitCast(words, at.x));
      const Taps taps = {
          hn::BitCast(bytes, columns * constants.step + hn::Load(words, tables.neighbours)),
          hn::BitCast(numbers, hn::Xor(fraction, constants.half)), at.y};
      for (int p = 0; p < kPlanes; ++p) {
        const std::uint8_t* source = sources[p];
        hwy::Prefetch(source + offsets[0] + static_cast<std::ptrdiff_t>(kAhead) * stride + 16);
        const Numbers sum =
            HWY_LIKELY(rows == 3)
                ? blend_three_rows<L, kNearest>(source, offsets, stride, taps, constants)
                : blend_more_rows<L>(source, offsets, stride, rows, taps);
        store_results<L>(hn::MulFixedPoint15(sum, constants.to_bytes), outputs[p]);
        outputs[p] += L::kOut;
      }
    }
  }
}

template <class L>
void blend_layout(const RunRow& row, int begin, int end, std::int32_t stride, bool nearest,
                  const PlaneRows& planes) {
  if (nearest) {
    for (int p = 0; p < planes.planes; ++p) {
      blend<L, true, 1>(row, begin, end, stride, {{planes.source[p]}, {planes.output[p]}, 1});
    }
  } else if (planes.planes == 2) {
    blend<L, false, 2>(row, begin, end, stride, planes);
  } else {
    blend<L, false, 1>(row, begin, end, stride, planes);
  }
}

// Runs of 8 samples, or of one lane.
template <int kComponents, int kSpacing>
void blend_length(int run, const RunRow& row, int begin, int end, std::int32_t stride, bool nearest,
                  const PlaneRows& planes) {
  using Long = Layout<kComponents, kSpacing, 8>;
  using Short = Layout<kComponents, kSpacing, Long::kPixels>;
  run == 8 ? blend_layout<Long>(row, begin, end, stride, nearest, planes)
           : blend_layout<Short>(row, begin, end, stride, nearest, planes);
}

void blend_row_of(LaneLayout layout, int run, const RunRow& row, int begin, int end,
                  std::int32_t stride, bool nearest, const PlaneRows& planes) {
  switch (layout) {
    case LaneLayout::kOne:
      return blend_length<1, 1>(run, row, begin, end, stride, nearest, planes);
    case LaneLayout::kTwo:
      return blend_length<2, 1>(run, row, begin, end, stride, nearest, planes);
    case LaneLayout::kThree:
      return blend_length<3, 1>(run, row, begin, end, stride, nearest, planes);
    case LaneLayout::kFour:
      return blend_length<4, 1>(run, row, begin, end, stride, nearest, planes);
    case LaneLayout::kOneSpread:
      return blend_length<1, 2>(run, row, begin, end, stride, nearest, planes);
    case LaneLayout::kTwoSpread:
      return blend_length<2, 2>(run, row, begin, end, stride, nearest, planes);
    default:
      return;
  }
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(blend_row_of);

void blend_runs(LaneLayout layout, int run, const RunRow& row, int begin, int end,
                std::int32_t stride, bool nearest, const PlaneRows& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(blend_row_of)(layout, run, row, begin, end, stride, nearest, planes);
}

}  // namespace calvin::remap
#endif
