// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of 16-bit samples, many at a time, for every instruction set. 16 bytes hold
// too few of them for the shuffles of lane_blend.cpp: each result gathers its own four neighbours,
// two of a row at a time, and is blended in single precision.

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_words.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_gathers-inl.hpp"
#include "calvin/remap/lane_places-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every lane is slow.

void blend_words_of(LaneLayout /*layout*/, WordFormat /*format*/, const RunRow& /*row*/,
                    int /*begin*/, int /*end*/, std::int32_t /*stride*/, bool /*nearest*/,
                    const PlaneRows& /*planes*/) {}

#else

using Floats = PlaceFloats;
using Ints = PlaceInts;
using Words = hn::RebindToUnsigned<Floats>;
using Values = hn::Vec<Floats>;

// Two 16-bit samples of each result, as their values.
struct Pair {
  Values low;
  Values high;
};
HWY_INLINE Pair pair_of(hn::Vec<Words> memory, WordFormat format) {
  return {value_at<true>(memory, format, 0), value_at<true>(memory, format, 16)};
}

// The inverse, of rounded values.
HWY_INLINE hn::Vec<Words> memory_of(const Pair& pair, WordFormat format) {
  const auto word = [&](Values v) HWY_ATTR {
    return hn::ShiftLeftSame(hn::BitCast(Words(), hn::NearestInt(v)), format.shift);
  };
  const auto memory = hn::Or(word(pair.low), hn::ShiftLeft<16>(word(pair.high)));
  return format.swapped ? swap_bytes(memory) : memory;
}

HWY_INLINE Values between(Values a, Values b, Values weight) {
  return hn::MulAdd(weight, b - a, a);
}

// One component: a pair is two neighbours.
HWY_INLINE void blend_one(const std::uint8_t* upper, const std::uint8_t* lower,
                          hn::Vec<Ints> offsets, Values across, Values down, WordFormat format,
                          std::uint8_t* out) {
  const Words d;
  const auto row = [&](const std::uint8_t* at) HWY_ATTR {
    const Pair v =
        pair_of(hn::GatherOffset(d, reinterpret_cast<const std::uint32_t*>(at), offsets), format);
    return between(v.low, v.high, across);
  };
  const auto value = between(row(upper), row(lower), down);
  const hn::Rebind<std::uint16_t, Words> half;
  const auto words = memory_of({value, hn::Zero(Floats())}, format);
  hn::StoreU(hn::DemoteTo(half, hn::BitCast(Ints(), words)), half,
             reinterpret_cast<std::uint16_t*>(out));
}

// Two components: a pair is one sample.
HWY_INLINE void blend_two(const std::uint8_t* upper, const std::uint8_t* lower,
                          hn::Vec<Ints> offsets, Values across, Values down, WordFormat format,
                          std::uint8_t* out) {
  const Words d;
  const auto row = [&](const std::uint8_t* at) HWY_ATTR {
    const auto* pairs = reinterpret_cast<const std::uint32_t*>(at);
    const Pair left = pair_of(hn::GatherOffset(d, pairs, offsets), format);
    const Pair right = pair_of(hn::GatherOffset(d, pairs + 1, offsets), format);
    return Pair{between(left.low, right.low, across), between(left.high, right.high, across)};
  };
  const Pair a = row(upper);
  const Pair b = row(lower);
  hn::StoreU(memory_of({between(a.low, b.low, down), between(a.high, b.high, down)}, format), d,
             reinterpret_cast<std::uint32_t*>(out));
}

constexpr int kAhead = 8;  // rows of the source that are fetched before they are needed

template <int kComponents>
HWY_INLINE void blend_lane(const RunRow& row, int j, WordFormat format, std::int32_t stride,
                           bool nearest, const PlaneRows& planes, std::ptrdiff_t begin) {
  const Floats d;
  const RunCurve px(row.x + j);
  const RunCurve py(row.y + j);
  constexpr int kStep = static_cast<int>(hn::MaxLanes(d));
  for (int i = 0; i < kPixels; i += kStep) {
    const RunPlaces x = places_at(px, i, nearest);
    const RunPlaces y = places_at(py, i, nearest);
    const auto offsets = y.whole * hn::Set(Ints(), stride) + hn::ShiftLeft<kComponents>(x.whole);
    for (int p = 0; p < planes.planes; ++p) {
      const std::uint8_t* source = planes.source[p];
      std::uint8_t* out = planes.output[p] + begin + 2 * kComponents * i;
      hwy::Prefetch(source + row.offset[j] + static_cast<std::ptrdiff_t>(kAhead) * stride + 16);
      if constexpr (kComponents == 1) {
        blend_one(source, source + stride, offsets, x.rest, y.rest, format, out);
      } else {
        blend_two(source, source + stride, offsets, x.rest, y.rest, format, out);
      }
    }
  }
}

void blend_words_of(LaneLayout layout, WordFormat format, const RunRow& row, int begin, int end,
                    std::int32_t stride, bool nearest, const PlaneRows& planes) {
  const int components = layout == LaneLayout::kOneWord ? 1 : 2;
  for (int j = begin; j < end; ++j) {
    if (row.rows[j] >= kSlowRun) continue;
    const std::ptrdiff_t at = (j - begin) * kPixels * 2 * components;
    components == 1 ? blend_lane<1>(row, j, format, stride, nearest, planes, at)
                    : blend_lane<2>(row, j, format, stride, nearest, planes, at);
  }
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(blend_words_of);

void blend_word_runs(LaneLayout layout, WordFormat format, const RunRow& row, int begin, int end,
                     std::int32_t stride, bool nearest, const PlaneRows& planes) noexcept {
  HWY_DYNAMIC_DISPATCH(blend_words_of)
  (layout, format, row, begin, end, stride, nearest, planes);
}

}  // namespace calvin::remap
#endif
