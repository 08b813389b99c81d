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

#include "calvin/remap/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every lane is slow.

void interpolate_row(const NodeRows& nodes, const float* weights, int count, LaneRow& row) {
  row.count = count;
  for (int j = 0; j < count + 2 * kMargin; ++j) {
    float x = 0;
    float y = 0;
    for (int r = 0; r < 4; ++r) {
      x += weights[r] * nodes.x[r][j];
      y += weights[r] * nodes.y[r][j];
    }
    row.x[j] = static_cast<std::int32_t>(std::lrint(x));
    row.y[j] = static_cast<std::int32_t>(std::lrint(y));
  }
}

void describe_row(LaneLayout /*layout*/, const SourceBounds& /*bounds*/, LaneRow& row) {
  std::fill_n(row.rows, row.count, kSlowLane);
}

void blend_row_of(LaneLayout /*layout*/, const LaneRow& /*row*/, std::int32_t /*stride*/,
                  bool /*nearest*/, const PlaneRows& /*planes*/) {}

int group() { return 1; }

#else

namespace hn = hwy::HWY_NAMESPACE;

// Vectors of unknown length are used as if they had 128 bits.
#if HWY_HAVE_SCALABLE
constexpr std::size_t kBytes = 16;
#else
constexpr std::size_t kBytes = HWY_LANES(std::uint8_t);
#endif
constexpr int kLanes = kBytes / 16;

using Bytes = hn::FixedTag<std::uint8_t, kBytes>;
using Words = hn::FixedTag<std::uint16_t, kBytes / 2>;
using Signed = hn::FixedTag<std::int16_t, kBytes / 2>;
using Ints = hn::FixedTag<std::int32_t, kBytes / 4>;
using Floats = hn::FixedTag<float, kBytes / 4>;
using Pairs = hn::Vec<Bytes>;
using Numbers = hn::Vec<Signed>;
using Places = hn::Vec<Words>;

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

// ---- Preparation: vectors of 32-bit numbers, one per lane.

// Places of 4.12 reach over 16 rows.
constexpr std::int32_t kMostRows = 15;

// What a lane's samples lie from its middle at most, in halves of a sample.
constexpr int reach(int pixels) { return pixels - 1; }

template <int kPixels>
struct Parabola {
  // Second difference of the middles -> what the parabola adds at the ends of a lane, 4.12.
  static constexpr int kFactor = kPixels == 8 ? 49 : kPixels == 4 ? 9 : 1;
  static constexpr int kShift = kPixels == 8 ? 11 : kPixels == 4 ? 9 : 7;
  // Difference of the neighbours' middles -> slope, 2.14.
  static constexpr int kSlopeShift = kPixels == 8 ? 4 : kPixels == 4 ? 3 : 2;
};

struct Axis {
  hn::Vec<Ints> first;  // sample
  hn::Vec<Ints> last;   // sample that the last place has for a neighbour
  hn::Vec<Ints> line;   // as in LaneRow
  hn::Vec<Ints> bend;   // 4.12
  hn::Vec<Ints> steep;  // size of the slope, 2.14
};

// `places` of two lanes before, of the lane, and of two behind; `rounding` is added to each.
template <int kPixels, bool kThird>
HWY_INLINE Axis describe(const std::int32_t* places, std::int32_t rounding) {
  using P = Parabola<kPixels>;
  const Ints d;
  const auto before = hn::LoadU(d, places + 1);
  const auto middle = hn::LoadU(d, places + 2);
  const auto after = hn::LoadU(d, places + 3);
  const auto second = before + after - middle - middle;
  const auto bend = hn::ShiftRight<P::kShift>(second * hn::Set(d, P::kFactor));
  auto across = after - before;
  if constexpr (kThird) {
    const auto third = hn::LoadU(d, places + 4) - hn::Load(d, places) - across - across;
    across = across - hn::ShiftRight<8>(third * hn::Set(d, kThirdPart));
  }
  const auto slope = hn::ShiftRight<P::kSlopeShift>(across);
  Axis axis;
  axis.steep = hn::Abs(slope);
  const auto half = hn::ShiftRight<1>(axis.steep * hn::Set(d, reach(kPixels))) +
                    hn::ShiftLeft<2>(hn::Abs(bend)) + hn::Set(d, 16);
  axis.first = hn::ShiftRight<kPlaceBits>(middle - half);
  axis.last = hn::ShiftRight<kPlaceBits>(middle + half + hn::Set(d, rounding)) + hn::Set(d, 1);
  const auto centre = middle + hn::ShiftLeft<1>(bend) + hn::Set(d, rounding + 2) -
                      hn::ShiftLeft<kPlaceBits>(axis.first);
  const auto low = hn::Set(d, 0xFFFF);
  axis.line = hn::Or(hn::And(hn::ShiftRight<2>(centre), low), hn::ShiftLeft<16>(slope));
  axis.bend = bend;
  return axis;
}

// The largest of the lanes that make a vector, in each of them.
HWY_INLINE hn::Vec<Ints> group_maximum(hn::Vec<Ints> rows) {
  if constexpr (kLanes >= 2) rows = hn::Max(rows, hn::Shuffle2301(rows));
  if constexpr (kLanes >= 4) rows = hn::Max(rows, hn::Shuffle1032(rows));
  return rows;
}

HWY_INLINE void interpolate(const float (&rows)[4][NodeRows::kLanes], const float* weights,
                            int count, std::int32_t* places) {
  const Floats d;
  const auto w0 = hn::Set(d, weights[0]);
  const auto w1 = hn::Set(d, weights[1]);
  const auto w2 = hn::Set(d, weights[2]);
  const auto w3 = hn::Set(d, weights[3]);
  for (int j = 0; j < count; j += static_cast<int>(hn::Lanes(d))) {
    const auto upper = hn::MulAdd(w1, hn::Load(d, rows[1] + j), w0 * hn::Load(d, rows[0] + j));
    const auto lower = hn::MulAdd(w3, hn::Load(d, rows[3] + j), w2 * hn::Load(d, rows[2] + j));
    hn::Store(hn::NearestInt(upper + lower), Ints(), places + j);
  }
}

template <int kPixels, int kStep, bool kThird>
HWY_INLINE void describe_all(const SourceBounds& b, LaneRow& row) {
  const Ints d;
  const auto zero = hn::Zero(d);
  auto most_bent = zero;
  for (int j = 0; j < row.count; j += static_cast<int>(hn::Lanes(d))) {
    // Half of what the horizontal weights are rounded to goes to the places.
    const Axis x = describe<kPixels, kThird>(row.x + j, 64);
    const Axis y = describe<kPixels, kThird>(row.y + j, 0);
    // All lanes of a vector read as many rows as the one that needs most.
    const auto rows = group_maximum(hn::Max(y.last - y.first + hn::Set(d, 1), hn::Set(d, 2)));
    const auto begin = x.first * hn::Set(d, kStep);
    // Any of these is negative where the lane cannot be taken quickly.
    auto spare = hn::Min(hn::Min(x.first, y.first), hn::Set(d, 0x7FFF) - hn::Max(x.steep, y.steep));
    spare = hn::Min(spare,
                    hn::Min(hn::Set(d, b.last_column) - x.last, hn::Set(d, b.last_row) - y.last));
    spare = hn::Min(
        spare, hn::Min(hn::Set(d, b.widest) - (x.last - x.first), hn::Set(d, kMostRows) - rows));
    const auto left = hn::Set(d, b.rows) - y.first - rows;
    spare = hn::Min(spare, left);
    // Segments may end behind a row, but for the last one.
    spare = hn::Min(spare,
                    hn::Max(left - hn::Set(d, b.guarded_rows), hn::Set(d, b.last_segment) - begin));
    const auto slow = hn::IfThenElse(spare < zero, hn::Set(d, kSlowLane), zero);
    hn::Store(hn::Max(group_maximum(slow), rows), d, row.rows + j);
    hn::Store(y.first * hn::Set(d, b.stride) + begin, d, row.offset + j);
    hn::Store(x.line, d, row.x_line + j);
    hn::Store(y.line, d, row.y_line + j);
    hn::Store(hn::Or(hn::And(x.bend, hn::Set(d, 0xFFFF)), hn::ShiftLeft<16>(y.bend)), d,
              row.bend + j);
    most_bent = hn::Max(most_bent, hn::Max(hn::Abs(x.bend), hn::Abs(y.bend)));
  }
  row.bent = hn::GetLane(hn::MaxOfLanes(d, most_bent)) > kStraight;
}

void interpolate_row(const NodeRows& nodes, const float* weights, int count, LaneRow& row) {
  row.count = count;
  interpolate(nodes.x, weights, count + 2 * kMargin, row.x);
  interpolate(nodes.y, weights, count + 2 * kMargin, row.y);
}

template <int kPixels, int kStep>
void describe_steps(const SourceBounds& bounds, LaneRow& row) {
  bounds.strongly_bent ? describe_all<kPixels, kStep, true>(bounds, row)
                       : describe_all<kPixels, kStep, false>(bounds, row);
}

void describe_row(LaneLayout layout, const SourceBounds& bounds, LaneRow& row) {
  switch (layout) {
    case LaneLayout::kOne:
      return describe_steps<8, 1>(bounds, row);
    case LaneLayout::kTwo:
      return describe_steps<4, 2>(bounds, row);
    case LaneLayout::kThree:
      return describe_steps<2, 3>(bounds, row);
    case LaneLayout::kFour:
      return describe_steps<2, 4>(bounds, row);
    case LaneLayout::kOneSpread:
      return describe_steps<8, 2>(bounds, row);
    case LaneLayout::kTwoSpread:
      return describe_steps<4, 4>(bounds, row);
    case LaneLayout::kNone:
      std::fill_n(row.rows, row.count, kSlowLane);
  }
}

// ---- Blending: vectors of eight results per lane.

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
    r.neighbours[i] = static_cast<std::uint16_t>(component | (component + L::kStep) << 8);
  }
  return r;
}
template <class L>
constexpr Results kResults = make_results<L>();

// Highway 1.0.3 has no multiplication of unsigned by signed bytes that adds up pairs. Weights are
// multiples of 1/128, and the blend is 128 times the value, or minus that: -128 is a byte, 128 not.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
constexpr std::int16_t kBackToBytes = -256;
constexpr std::uint16_t kNoFraction = 0x80;
constexpr std::int16_t kFractionStep = -255;
HWY_INLINE Numbers blend_pairs(Pairs pairs, Pairs weights) {
#if HWY_TARGET <= HWY_AVX3
  return Numbers{_mm512_maddubs_epi16(pairs.raw, weights.raw)};
#elif HWY_TARGET <= HWY_AVX2
  return Numbers{_mm256_maddubs_epi16(pairs.raw, weights.raw)};
#else
  return Numbers{_mm_maddubs_epi16(pairs.raw, weights.raw)};
#endif
}
#else
constexpr std::int16_t kBackToBytes = 256;
constexpr std::uint16_t kNoFraction = 0x80;
constexpr std::int16_t kFractionStep = 255;
HWY_INLINE Numbers blend_pairs(Pairs pairs, Pairs weights) {
  const Words d;
  const auto low = hn::Set(d, 0xFF);
  const auto p = hn::BitCast(d, pairs);
  const auto w = hn::BitCast(d, weights);
  return hn::BitCast(
      Signed(), hn::And(p, low) * hn::And(w, low) + hn::ShiftRight<8>(p) * hn::ShiftRight<8>(w));
}
#endif

// The 16 samples that begin at a byte: one after the other, or in every second byte.
template <int kSpread, class D>
HWY_INLINE hn::Vec<D> load_segments(D d, const std::uint8_t* plane, const std::int32_t* offsets) {
  constexpr std::size_t kSize = hn::MaxLanes(D());
  if constexpr (kSize > 16) {
    const hn::FixedTag<std::uint8_t, kSize / 2> half;
    return hn::Combine(d, load_segments<kSpread>(half, plane, offsets + kSize / 32),
                       load_segments<kSpread>(half, plane, offsets));
  } else if constexpr (kSpread == 2) {
    const std::uint8_t* at = plane + offsets[0];
    return hn::ConcatEven(d, hn::LoadU(d, at + 16), hn::LoadU(d, at));
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
  Pairs neighbours;  // which bytes of a segment
  Pairs weights;     // across
  Places down;       // place below the segment's first row, 4.12
};

struct Constants {
  Places whole;  // a weight of 1 for MulFixedPoint15
  Places two_rows;
  Places fraction;
  Numbers fraction_step;
  Numbers no_fraction;
  Numbers back;
};
HWY_INLINE Constants make_constants() {
  const Words words;
  const Signed numbers;
  return {kept(hn::Set(words, 0x7FFF)),        kept(hn::Set(words, 0x8000)),
          kept(hn::Set(words, 0x7F)),          kept(hn::Set(numbers, kFractionStep)),
          kept(hn::Set(numbers, kNoFraction)), kept(hn::Set(numbers, kBackToBytes))};
}

template <int kSpread>
HWY_INLINE Numbers blend_row(const std::uint8_t* source, const std::int32_t* offsets,
                             const Taps& taps) {
  return blend_pairs(
      hn::TableLookupBytes(load_segments<kSpread>(Bytes(), source, offsets), taps.neighbours),
      taps.weights);
}

// `rows` source rows, each result between two of them.
template <int kSpread>
HWY_INLINE Numbers blend_rows(const std::uint8_t* source, const std::int32_t* offsets,
                              std::int32_t stride, std::int32_t rows, const Taps& taps,
                              const Constants& constants) {
  const Words words;
  const Signed numbers;
  const auto below = [&](Numbers upper, Numbers lower, Places weight) HWY_ATTR {
    return hn::MulFixedPoint15(lower - upper, hn::BitCast(numbers, weight));
  };
  const Numbers first = blend_row<kSpread>(source, offsets, taps);
  Numbers upper = blend_row<kSpread>(source + stride, offsets, taps);
  const auto down = hn::ShiftLeft<3>(taps.down);
  Numbers sum = first + below(first, upper, hn::Min(down, constants.whole));
  if (rows == 2) return sum;
  if (HWY_LIKELY(rows == 3)) {
    const Numbers lower =
        blend_row<kSpread>(source + 2 * static_cast<std::ptrdiff_t>(stride), offsets, taps);
    return sum + below(upper, lower, hn::SaturatedSub(down, constants.two_rows));
  }
  // From here on 15 bits do not hold the place.
  const auto row = hn::Set(words, 4096);
  const auto last = hn::Set(words, 4095);
  sum = first + below(first, upper, hn::ShiftLeft<3>(hn::Min(taps.down, last)));
  auto place = hn::SaturatedSub(taps.down, row);
  for (std::int32_t r = 2; r < rows; ++r) {
    const Numbers lower =
        blend_row<kSpread>(source + r * static_cast<std::ptrdiff_t>(stride), offsets, taps);
    sum = sum + below(upper, lower, hn::ShiftLeft<3>(hn::Min(place, last)));
    place = hn::SaturatedSub(place, row);
    upper = lower;
  }
  return sum;
}

// Rows of the source that are fetched before they are needed: the hardware does not foresee a walk
// along a curve.
constexpr int kAhead = 12;

template <class L, bool kBent, bool kNearest, int kPlanes>
void blend(const LaneRow& row, std::int32_t stride, const PlaneRows& planes) {
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
  const auto step = kept(hn::Set(words, 0x101 * L::kStep));
  const auto half = [&](Pairs records, Pairs which) HWY_ATTR {
    return hn::BitCast(numbers, hn::TableLookupBytes(records, which));
  };
  const auto records = [&](const std::int32_t* at) HWY_ATTR {
    return hn::LoadDup128(bytes, reinterpret_cast<const std::uint8_t*>(at));
  };
  // What is written may be anything for all that the compiler knows.
  const int count = row.count;
  std::array<const std::uint8_t*, kPlanes> sources;
  std::array<std::uint8_t*, kPlanes> outputs;
  for (int p = 0; p < kPlanes; ++p) {
    sources[p] = planes.source[p];
    outputs[p] = planes.output[p];
  }
  for (int j = 0; j < count; j += kLanes) {
    const std::int32_t rows = row.rows[j];
    if (HWY_UNLIKELY(rows >= kSlowLane)) continue;
    const Pairs x_line = records(row.x_line + j);
    const Pairs y_line = records(row.y_line + j);
    auto x = half(x_line, low) + hn::MulFixedPoint15(half(x_line, high), along);
    auto y = half(y_line, low) + hn::MulFixedPoint15(half(y_line, high), along);
    if constexpr (kBent) {
      const Pairs bend = records(row.bend + j);
      x = x + hn::MulFixedPoint15(half(bend, low), square);
      y = y + hn::MulFixedPoint15(half(bend, high), square);
    }
    auto across = hn::BitCast(words, x);
    Taps taps;
    taps.down = hn::BitCast(words, y);
    if constexpr (kNearest) {
      across = hn::And(across + hn::Set(words, 2048 - 16), hn::Set(words, 0xF000));
      taps.down = hn::And(taps.down + hn::Set(words, 2048), hn::Set(words, 0xF000));
      // blend_rows() has 16 bits for eight times the place.
      if (rows == 3) taps.down = hn::Min(taps.down, hn::Set(words, 8191));
    }
    taps.neighbours = hn::BitCast(bytes, hn::ShiftRight<12>(across) * step + neighbours);
    const auto fraction =
        hn::BitCast(numbers, hn::And(hn::ShiftRight<5>(across), constants.fraction));
    taps.weights = hn::BitCast(bytes, fraction * constants.fraction_step + constants.no_fraction);
    for (int p = 0; p < kPlanes; ++p) {
      const std::uint8_t* source = sources[p];
      hwy::Prefetch(source + row.offset[j] + static_cast<std::ptrdiff_t>(kAhead) * stride + 16);
      const Numbers sum =
          blend_rows<L::kSpread>(source, row.offset + j, stride, rows, taps, constants);
      store_results<L>(hn::MulFixedPoint15(sum, constants.back), outputs[p] + j / kLanes * L::kOut);
    }
  }
}

template <class L, bool kBent>
void blend_kind(const LaneRow& row, std::int32_t stride, bool nearest, const PlaneRows& planes) {
  if (nearest) {
    for (int p = 0; p < planes.planes; ++p) {
      blend<L, kBent, true, 1>(row, stride, {{planes.source[p]}, {planes.output[p]}, 1});
    }
  } else if (planes.planes == 2) {
    blend<L, kBent, false, 2>(row, stride, planes);
  } else {
    blend<L, kBent, false, 1>(row, stride, planes);
  }
}

template <class L>
void blend_layout(const LaneRow& row, std::int32_t stride, bool nearest, const PlaneRows& planes) {
  row.bent ? blend_kind<L, true>(row, stride, nearest, planes)
           : blend_kind<L, false>(row, stride, nearest, planes);
}

void blend_row_of(LaneLayout layout, const LaneRow& row, std::int32_t stride, bool nearest,
                  const PlaneRows& planes) {
  switch (layout) {
    case LaneLayout::kOne:
      return blend_layout<Layout<1, 1>>(row, stride, nearest, planes);
    case LaneLayout::kTwo:
      return blend_layout<Layout<2, 1>>(row, stride, nearest, planes);
    case LaneLayout::kThree:
      return blend_layout<Layout<3, 1>>(row, stride, nearest, planes);
    case LaneLayout::kFour:
      return blend_layout<Layout<4, 1>>(row, stride, nearest, planes);
    case LaneLayout::kOneSpread:
      return blend_layout<Layout<1, 2>>(row, stride, nearest, planes);
    case LaneLayout::kTwoSpread:
      return blend_layout<Layout<2, 2>>(row, stride, nearest, planes);
    case LaneLayout::kNone:
      return;
  }
}

int group() { return kLanes; }

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(interpolate_row);
HWY_EXPORT(describe_row);
HWY_EXPORT(blend_row_of);
HWY_EXPORT(group);

void interpolate_lanes(const NodeRows& nodes, const float* weights, int count,
                       LaneRow& row) noexcept {
  HWY_DYNAMIC_DISPATCH(interpolate_row)(nodes, weights, count, row);
}

void describe_lanes(LaneLayout layout, const SourceBounds& bounds, LaneRow& row) noexcept {
  HWY_DYNAMIC_DISPATCH(describe_row)(layout, bounds, row);
}

void blend_lanes(LaneLayout layout, const LaneRow& row, std::int32_t stride, bool nearest,
                 const PlaneRows& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(blend_row_of)(layout, row, stride, nearest, planes);
}

int lane_group() noexcept { return HWY_DYNAMIC_DISPATCH(group)(); }

}  // namespace calvin::remap
#endif
