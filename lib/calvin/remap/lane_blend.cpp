// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling, many samples at a time, for every instruction set that there is.
//
// A vector is as many 128-bit lanes as the machine has, and a lane eight results: samples that lie
// next to each other in the output. Their places in the source lie next to each other too, so that
// 16 bytes of each source row hold all of them. One byte shuffle fetches the pairs of neighbours,
// one multiplication of pairs blends them across, and two to four such rows are blended down.
// Everything that differs between memory layouts is in `Layout` and in two functions that load and
// store.

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_blend.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every lane is slow.

void blend_row_of(LaneLayout /*layout*/, const LaneRow& /*row*/, int /*begin*/, int /*end*/,
                  std::int32_t /*stride*/, bool /*nearest*/, const PlaneRows& /*planes*/) {}

#else

template <int kComponents, int kSpacing>
struct Layout {
  static constexpr int kSpread = kSpacing;                                // bytes per sample
  static constexpr int kStep = kComponents;                               // bytes, once gathered
  static constexpr int kWidth = kComponents == 3 ? 4 : kComponents;       // results per pixel
  static constexpr int kPixels = 8 / kWidth;                              // per lane
  static constexpr int kOut = kPixels * kComponents * kSpacing * kLanes;  // bytes per vector
};

// Compilers make constants anew at every use, on the port that shuffles need. One that they do not
// know stays in its register.
template <class V>
HWY_INLINE V kept(V v) {
#if HWY_ARCH_X86 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG) && HWY_TARGET <= HWY_AVX3
  asm("" : "+v"(v.raw));
#endif
  return v;
}

// Which bytes of four lanes' 32-bit records fill each lane with one of their halves.
struct Halves {
  alignas(64) std::uint8_t low[64];
  alignas(64) std::uint8_t high[64];
};
constexpr Halves make_halves() {
  Halves h{};
  for (int i = 0; i < 64; ++i) {
    h.low[i] = static_cast<std::uint8_t>(4 * (i / 16) + i % 2);
    h.high[i] = static_cast<std::uint8_t>(h.low[i] + 2);
  }
  return h;
}
constexpr Halves kHalves = make_halves();

// What each result of a lane adds to the lane's numbers.
struct Results {
  alignas(64) std::int16_t along[32];        // slope 2.14 -> place 4.12, through MulFixedPoint15
  alignas(64) std::int16_t square[32];       // bend -> place 4.12, likewise
  alignas(64) std::uint16_t neighbours[32];  // bytes of the two samples in a pixel and the next one
};
template <class L>
constexpr Results make_results() {
  Results r{};
  for (int i = 0; i < 32; ++i) {
    const int pixel = i % 8 / L::kWidth;
    const int component = i % L::kWidth < L::kStep ? i % L::kWidth : 0;
    const int halves = 2 * pixel - reach(L::kPixels);
    const double end = reach(L::kPixels);
    r.along[i] = static_cast<std::int16_t>(halves * 4096);
    r.square[i] = static_cast<std::int16_t>((halves * halves / (end * end) - 0.5) * 32767);
    r.neighbours[i] =
        static_cast<std::uint16_t>((component | (component + L::kStep) << 8) * L::kSpread);
  }
  return r;
}
template <class L>
constexpr Results kResults = make_results<L>();

struct Constants {
  Places half;       // from fractions to weights
  Pairs sum;         // of two bytes, times 64
  Pairs difference;  // likewise
  Numbers to_bytes;  // 1/128 for MulFixedPoint15
};
HWY_INLINE Constants make_constants() {
  const Words words;
  return {kept(hn::Set(words, 0x8000)), kept(hn::BitCast(Bytes(), hn::Set(words, 0x4040))),
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

// The 16 bytes that begin at each lane's offset.
template <class D>
HWY_INLINE hn::Vec<D> load_segments(D d, const std::uint8_t* plane, const std::int32_t* offsets) {
  constexpr std::size_t kSize = hn::MaxLanes(D());
  if constexpr (kSize > 16) {
    const hn::FixedTag<std::uint8_t, kSize / 2> half;
    return hn::Combine(d, load_segments(half, plane, offsets + kSize / 32),
                       load_segments(half, plane, offsets));
  } else {
    return hn::LoadU(d, plane + offsets[0]);
  }
}

template <class L>
HWY_INLINE void store_results(Numbers results, std::uint8_t* out) {
  constexpr std::size_t kHalf = kBytes / 2;
  const hn::FixedTag<std::uint8_t, kHalf> d;
  if constexpr (L::kSpread == 2) {
    const Words words;
    auto* at = reinterpret_cast<std::uint16_t*>(out);
    const auto others = hn::And(hn::LoadU(words, at), hn::Set(words, 0xFF00));
    hn::StoreU(hn::Or(others, hn::BitCast(words, results)), words, at);
  } else if constexpr (L::kStep == 3) {
    // Six of eight results are samples: they go to the front, and the next lane's over the rest.
    alignas(16) static constexpr std::uint8_t kFront[16] = {0,  1,  2,  3,  4, 5, 8, 9,
                                                            10, 11, 12, 13, 0, 0, 0, 0};
    const Bytes all;
    const auto front = hn::TableLookupBytes(hn::BitCast(all, results), hn::LoadDup128(all, kFront));
    alignas(64) std::uint8_t lanes[kHalf];
    hn::Store(hn::DemoteTo(d, hn::BitCast(Signed(), front)), d, lanes);
    for (int l = 0; l < kLanes; ++l) std::memcpy(out + 6 * l, lanes + 8 * l, 8);
  } else {
    hn::StoreU(hn::DemoteTo(d, results), d, out);
  }
}

// What a vector of results takes from the source.
struct Taps {
  Pairs neighbours;  // which bytes, from the beginning of the segment
  Numbers across;    // twice the weight of the second of two neighbours, less 1; 1.15
  Places down;       // place below the segment's first row, 4.12
};

// The indices within the first 16 bytes, as they are; the others such that nothing is taken.
HWY_INLINE Pairs within_segment(Pairs indices) {
  const Words d;
  const auto words = hn::BitCast(d, indices);
  return hn::BitCast(Bytes(), hn::Or(words, hn::ShiftLeft<3>(hn::And(words, hn::Set(d, 0x1010)))));
}

// Samples in every second byte lie in two segments.
template <int kSpread>
HWY_INLINE Pairs fetch_pairs(const std::uint8_t* source, const std::int32_t* offsets,
                             const Taps& taps) {
  const Bytes d;
  const Pairs segments = load_segments(d, source, offsets);
  if constexpr (kSpread == 1) {
    return hn::TableLookupBytes(segments, taps.neighbours);
  } else {
    const Pairs more = load_segments(d, source + 16, offsets);
    const Pairs rest = hn::Xor(taps.neighbours, hn::Set(d, 0x10));
    return hn::Or(hn::TableLookupBytesOr0(segments, within_segment(taps.neighbours)),
                  hn::TableLookupBytesOr0(more, within_segment(rest)));
  }
}

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
template <int kSpread>
HWY_INLINE Numbers blend_three_rows(const std::uint8_t* source, const std::int32_t* offsets,
                                    std::int32_t stride, const Taps& taps,
                                    const Constants& constants) {
  const Bytes bytes;
  const Signed numbers;
  // From the middle row, 1.15.
  const auto place = hn::BitCast(numbers, hn::Xor(hn::ShiftLeft<3>(taps.down), constants.half));
  const std::uint8_t* second = source + stride;
  const auto above = hn::BitCast(numbers, fetch_pairs<kSpread>(source, offsets, taps));
  const auto below = hn::BitCast(numbers, fetch_pairs<kSpread>(second + stride, offsets, taps));
  const auto outer = hn::IfThenElse(negative(place), above, below);
  const Numbers middle = blend_row(fetch_pairs<kSpread>(second, offsets, taps), taps, constants);
  const Numbers other = blend_row(hn::BitCast(bytes, outer), taps, constants);
  return middle + hn::MulFixedPoint15(other - middle, hn::Abs(place));
}

// `rows` source rows, each result between two of them. Rare, and apart from the others so that
// these keep their registers.
template <int kSpread>
HWY_NOINLINE Numbers blend_more_rows(const std::uint8_t* source, const std::int32_t* offsets,
                                     std::int32_t stride, std::int32_t rows, Taps taps) {
  const Words words;
  const Signed numbers;
  const Constants constants = make_constants();
  // 15 bits do not hold the place.
  const auto row = hn::Set(words, 4096);
  const auto last = hn::Set(words, 4095);
  Numbers upper = blend_row(fetch_pairs<kSpread>(source, offsets, taps), taps, constants);
  Numbers sum = upper;
  for (std::int32_t r = 1; r < rows; ++r) {
    source += stride;
    const Numbers lower = blend_row(fetch_pairs<kSpread>(source, offsets, taps), taps, constants);
    const auto weight = hn::BitCast(numbers, hn::ShiftLeft<3>(hn::Min(taps.down, last)));
    sum = sum + hn::MulFixedPoint15(lower - upper, weight);
    taps.down = hn::SaturatedSub(taps.down, row);
    upper = lower;
  }
  return sum;
}

// Rows of the source that are fetched before they are needed: the hardware does not foresee a walk
// along a curve.
constexpr int kAhead = 12;

template <class L, bool kNearest, int kPlanes>
void blend(const LaneRow& row, int begin, int end, std::int32_t stride, const PlaneRows& planes) {
  const Words words;
  const Signed numbers;
  const Bytes bytes;
  const auto& tables = kResults<L>;
  const Constants constants = make_constants();
  const auto low = hn::Load(bytes, kHalves.low);
  const auto high = hn::Load(bytes, kHalves.high);
  const auto along = hn::Load(numbers, tables.along);
  const auto square = hn::Load(numbers, tables.square);
  const auto neighbours = hn::Load(words, tables.neighbours);
  const auto step = kept(hn::Set(words, 0x101 * L::kStep * L::kSpread));
  const auto half = [&](Pairs records, Pairs which) HWY_ATTR {
    return hn::BitCast(numbers, hn::TableLookupBytes(records, which));
  };
  const auto records = [&](const std::int32_t* at) HWY_ATTR {
    return hn::LoadDup128(bytes, reinterpret_cast<const std::uint8_t*>(at));
  };
  const auto nearest = [&](Places places) HWY_ATTR {
    return hn::And(places + hn::Set(words, 2048), hn::Set(words, 0xF000));
  };
  // What is written may be anything for all that the compiler knows.
  std::array<const std::uint8_t*, kPlanes> sources;
  std::array<std::uint8_t*, kPlanes> outputs;
  for (int p = 0; p < kPlanes; ++p) {
    sources[p] = planes.source[p];
    outputs[p] = planes.output[p];
  }
  for (int j = begin; j < end; j += kLanes) {
    const std::int32_t rows = row.rows[j];
    if (HWY_UNLIKELY(rows >= kSlowLane)) continue;
    const Pairs x_line = records(row.x_line + j);
    const Pairs y_line = records(row.y_line + j);
    auto x = half(x_line, low) + hn::MulFixedPoint15(half(x_line, high), along);
    auto y = half(y_line, low) + hn::MulFixedPoint15(half(y_line, high), along);
    if constexpr (L::kPixels > 2) {
      const Pairs bend = records(row.bend + j);
      x = x + hn::MulFixedPoint15(half(bend, low), square);
      y = y + hn::MulFixedPoint15(half(bend, high), square);
    }
    auto across = hn::BitCast(words, x);
    Taps taps;
    taps.down = hn::BitCast(words, y);
    if constexpr (kNearest) {
      across = nearest(across);
      // blend_three_rows() has 16 bits for eight times the place, and no -1.
      taps.down = nearest(taps.down);
      if (rows == 3) {
        taps.down = hn::Max(hn::Min(taps.down, hn::Set(words, 8191)), hn::Set(words, 1));
      }
    }
    taps.neighbours = hn::BitCast(bytes, hn::ShiftRight<12>(across) * step + neighbours);
    taps.across = hn::BitCast(numbers, hn::Xor(hn::ShiftLeft<4>(across), constants.half));
    for (int p = 0; p < kPlanes; ++p) {
      const std::uint8_t* source = sources[p];
      hwy::Prefetch(source + row.offset[j] + static_cast<std::ptrdiff_t>(kAhead) * stride + 16);
      const Numbers sum =
          HWY_LIKELY(rows == 3)
              ? blend_three_rows<L::kSpread>(source, row.offset + j, stride, taps, constants)
              : blend_more_rows<L::kSpread>(source, row.offset + j, stride, rows, taps);
      store_results<L>(hn::MulFixedPoint15(sum, constants.to_bytes),
                       outputs[p] + (j - begin) / kLanes * L::kOut);
    }
  }
}

template <class L>
void blend_layout(const LaneRow& row, int begin, int end, std::int32_t stride, bool nearest,
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

void blend_row_of(LaneLayout layout, const LaneRow& row, int begin, int end, std::int32_t stride,
                  bool nearest, const PlaneRows& planes) {
  switch (layout) {
    case LaneLayout::kOne:
      return blend_layout<Layout<1, 1>>(row, begin, end, stride, nearest, planes);
    case LaneLayout::kTwo:
      return blend_layout<Layout<2, 1>>(row, begin, end, stride, nearest, planes);
    case LaneLayout::kThree:
      return blend_layout<Layout<3, 1>>(row, begin, end, stride, nearest, planes);
    case LaneLayout::kFour:
      return blend_layout<Layout<4, 1>>(row, begin, end, stride, nearest, planes);
    case LaneLayout::kOneSpread:
      return blend_layout<Layout<1, 2>>(row, begin, end, stride, nearest, planes);
    case LaneLayout::kTwoSpread:
      return blend_layout<Layout<2, 2>>(row, begin, end, stride, nearest, planes);
    case LaneLayout::kNone:
      return;
  }
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(blend_row_of);

void blend_lanes(LaneLayout layout, const LaneRow& row, int begin, int end, std::int32_t stride,
                 bool nearest, const PlaneRows& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(blend_row_of)(layout, row, begin, end, stride, nearest, planes);
}

}  // namespace calvin::remap
#endif
