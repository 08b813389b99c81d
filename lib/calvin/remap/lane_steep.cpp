// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling along lines of any slope, for every instruction set: each
// pixel is gathered by its own address together with its neighbour. For runs whose samples lie too
// far apart for the other kernels: much smaller outputs, wide views. A vector has one pixel of each
// of as many runs as it has 32-bit numbers, so that what is known of runs need not be spread.

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_steep.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_gathered-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

bool blend_steep(LaneLayout /*layout*/, WordFormat /*format*/, const SourceBounds& /*bounds*/,
                 const RunRow& /*row*/, int begin, int end, bool /*nearest*/,
                 const std::uint8_t* /*source*/, std::uint8_t* /*output*/, bool* left) {
  std::fill_n(left, end - begin, true);
  return true;
}

#else

constexpr int kPixels = 8;                           // of a run
constexpr int kRuns = static_cast<int>(kBytes / 4);  // of a vector

// ---- Where the pixels are.

// Parabolas through the middles of runs, as RunParabola, from the sample that each middle is
// behind: differences of middles near the source are small, so that single precision holds all of
// them.
struct Curves {
  hn::Vec<Ints> base;
  hn::Vec<Floats> rest;
  hn::Vec<Floats> slope;
  hn::Vec<Floats> bend;
};

// `middles` of two runs before the first, and on.
HWY_INLINE Curves curves_at(const std::int32_t* middles) {
  constexpr float kUnit = 1.0F / (1 << kPlaceBits);
  const Ints d;
  const Floats floats;
  const auto middle = hn::LoadU(d, middles + 2);
  const auto before = middle - hn::LoadU(d, middles + 1);
  const auto after = hn::LoadU(d, middles + 3) - middle;
  const auto wide = hn::LoadU(d, middles + 4) - hn::LoadU(d, middles);
  const auto across = hn::ConvertTo(floats, before + after);
  const auto third = hn::ConvertTo(floats, wide) - across - across;
  const auto part = hn::And(middle, hn::Set(d, (1 << kPlaceBits) - 1));
  return {hn::ShiftRight<kPlaceBits>(middle), hn::ConvertTo(floats, part) * hn::Set(floats, kUnit),
          hn::NegMulAdd(third, hn::Set(floats, kThirdPart / 256.0F), across) *
              hn::Set(floats, kUnit / (2 * kPixels)),
          hn::ConvertTo(floats, after - before) * hn::Set(floats, kUnit / (2 * kPixels * kPixels))};
}

// Differences of what lies farther out may not fit into 32 bits.
constexpr std::int32_t kFarthest = 1 << 29;

// The farthest of the middles that a vector of runs is made with.
HWY_INLINE hn::Vec<Unsigned> farthest_of(const std::int32_t* middles) {
  auto farthest = hn::Zero(Unsigned());
  for (int k = 0; k <= 2 * kMargin; ++k) {
    const auto far = hn::Abs(hn::LoadU(Ints(), middles + k));
    farthest = hn::Max(farthest, hn::BitCast(Unsigned(), far));
  }
  return farthest;
}

// Along one axis: whole samples, and the rest.
struct Places {
  hn::Vec<Unsigned> whole;  // what is negative is large
  hn::Vec<Floats> rest;
};
// Of the pixels that lie `from_middle` samples from the middles of their runs.
HWY_INLINE Places places_at(const Curves& curves, float from_middle, bool nearest) {
  const Floats d;
  const auto t = hn::Set(d, from_middle);
  const auto at = hn::MulAdd(t, hn::MulAdd(t, curves.bend, curves.slope), curves.rest);
  const auto down = hn::Floor(at);
  const auto rest = at - down;
  return {hn::BitCast(Unsigned(), small_ints(down) + curves.base),
          nearest ? hn::Round(rest) : rest};
}

// Whether none of those that went into a maximum exceeds the limit.
HWY_INLINE hn::Mask<Unsigned> all_within(hn::Vec<Unsigned> largest, std::int32_t limit) {
  const auto bound = hn::Set(Unsigned(), static_cast<std::uint32_t>(limit));
  return hn::Eq(hn::Max(largest, bound), bound);
}

// ---- Runs.

// The largest of what the pixels of a block asked for.
struct Needs {
  hn::Vec<Unsigned> column;
  hn::Vec<Unsigned> row;
  hn::Vec<Unsigned> offset;
};

// The pixels at `x` and `y`.
template <class M>
HWY_INLINE hn::Vec<Ints> pixels_at(const Picture& picture, const Places& x, const Places& y,
                                   Needs& needs) {
  const Unsigned d;
  const auto offset = y.whole * hn::Set(d, static_cast<std::uint32_t>(picture.stride)) +
                      x.whole * hn::Set(d, M::kStep);
  needs.column = hn::Max(needs.column, x.whole);
  needs.row = hn::Max(needs.row, y.whole);
  needs.offset = hn::Max(needs.offset, offset);
  const auto at = hn::BitCast(Ints(), hn::Min(offset, picture.last_offset));
  return M::pixels(picture, at, x.rest, y.rest);
}

// The first of each two bytes, or of each two 16-bit numbers, of both.
HWY_INLINE hn::Vec<Ints> join_bytes(hn::Vec<Ints> first, hn::Vec<Ints> second) {
  return hn::BitCast(Ints(),
                     even_and_odd(hn::BitCast(Bytes(), first), up(hn::BitCast(Bytes(), second))));
}
HWY_INLINE hn::Vec<Ints> join_words(hn::Vec<Ints> first, hn::Vec<Ints> second) {
  return hn::BitCast(Ints(), hn::OddEven(hn::BitCast(Signed(), hn::ShiftLeft<16>(second)),
                                         hn::BitCast(Signed(), first)));
}

// Vectors of pixels, each with one of every run, become runs in memory. Pixels of 3 and 4 bytes are
// 32-bit words: all first halves of runs, then all second ones.
template <class M>
HWY_INLINE void turn_block(const std::int32_t* pixels, std::int32_t* to) {
  const Ints d;
  const auto pixel = [&](int i) HWY_ATTR { return hn::Load(d, pixels + i * kRuns); };
  if constexpr (M::kStep == 1) {
    const auto four = [&](int i) HWY_ATTR {
      return join_words(join_bytes(pixel(i), pixel(i + 1)), join_bytes(pixel(i + 2), pixel(i + 3)));
    };
    hn::StoreInterleaved2(four(0), four(4), d, to);
  } else if constexpr (M::kStep == 2) {
    const auto two = [&](int i) HWY_ATTR { return join_words(pixel(i), pixel(i + 1)); };
    hn::StoreInterleaved4(two(0), two(2), two(4), two(6), d, to);
  } else {
    for (int i = 0; i < kPixels; i += 4) {
      hn::StoreInterleaved4(pixel(i), pixel(i + 1), pixel(i + 2), pixel(i + 3), d, to + i * kRuns);
    }
  }
}

// Sixteen bytes from turn_block() to where they belong: what lies between components that are apart
// is not ours.
template <class M>
HWY_INLINE void put_pixels(const std::int32_t* from, std::uint8_t* to) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(from);
  if constexpr (M::kSpread) {
    HWY_UNROLL(8)
    for (int i = 0; i < 16; i += 2) to[i] = bytes[i];
  } else if constexpr (M::kStep == 3) {
    alignas(16) static constexpr std::uint8_t kFront[16] = {0,  1,  2,  4,  5, 6, 8, 9,
                                                            10, 12, 13, 14, 0, 0, 0, 0};
    const hn::FixedTag<std::uint8_t, 16> d;
    alignas(16) std::uint8_t front[16];
    hn::Store(hn::TableLookupBytes(hn::Load(d, bytes), hn::Load(d, kFront)), d, front);
    std::memcpy(to, front, 12);
  } else {
    std::memcpy(to, bytes, 16);
  }
}

// As many runs.
template <class M>
HWY_INLINE void put_block(const std::int32_t* from, int runs, std::uint8_t* output) {
  if constexpr (M::kStep == 1) {
    std::memcpy(output, from, static_cast<std::size_t>(runs) * kPixels);
  } else if constexpr (M::kStep == 2) {
    for (int r = 0; r < runs; ++r) put_pixels<M>(from + 4 * r, output + 16 * r);
  } else {
    for (int r = 0; r < runs; ++r, output += kPixels * M::kStep) {
      put_pixels<M>(from + 4 * r, output);
      put_pixels<M>(from + 4 * (r + kRuns), output + 4 * M::kStep);
    }
  }
}

// Where the middles of a vector of runs are: their lines are fetched before they are needed.
template <class M>
HWY_INLINE void store_middles(const Picture& picture, const RunRow& row, int run,
                              std::uint32_t* to) {
  const Unsigned d;
  const auto whole = [&](const std::int32_t* middles) HWY_ATTR {
    const auto middle = hn::LoadU(Ints(), middles + run + kMargin);
    return hn::BitCast(d, hn::ShiftRight<kPlaceBits>(middle));
  };
  const auto offset = whole(row.y) * hn::Set(d, static_cast<std::uint32_t>(picture.stride)) +
                      whole(row.x) * hn::Set(d, M::kStep);
  hn::Store(hn::Min(offset, picture.last_offset), d, to);
}

// A vector of runs, the first of which is `run`; which of them could be made.
template <class M>
HWY_INLINE hn::Mask<Unsigned> blend_block(const Picture& picture, const SourceBounds& bounds,
                                          const RunRow& row, int run, bool nearest,
                                          std::int32_t* to) {
  const Curves x = curves_at(row.x + run);
  const Curves y = curves_at(row.y + run);
  alignas(64) std::int32_t pixels[kPixels * kRuns];
  alignas(64) std::uint32_t next[kRuns];
  store_middles<M>(picture, row, run + kRuns, next);
  const auto none = hn::Zero(Unsigned());
  Needs needs = {none, none, none};
  for (int i = 0; i < kPixels; ++i) {
    for (int r = i * kRuns / kPixels; r < (i + 1) * kRuns / kPixels; ++r) {
      hwy::Prefetch(picture.source + next[r]);
      hwy::Prefetch(picture.source + picture.stride + next[r]);
    }
    const float from_middle = static_cast<float>(2 * i - reach(kPixels)) / 2;
    const auto values = pixels_at<M>(picture, places_at(x, from_middle, nearest),
                                     places_at(y, from_middle, nearest), needs);
    hn::Store(values, Ints(), pixels + i * kRuns);
  }
  turn_block<M>(pixels, to);
  const auto far = hn::Max(farthest_of(row.x + run), farthest_of(row.y + run));
  return hn::And(hn::And(all_within(needs.column, bounds.last_column - 1),
                         all_within(needs.row, bounds.last_row - 1)),
                 hn::And(hn::Eq(needs.offset, hn::Min(needs.offset, picture.last_offset)),
                         all_within(far, kFarthest)));
}

template <class M>
bool blend_runs(WordFormat format, const SourceBounds& bounds, const RunRow& row, int begin,
                int end, bool nearest, const std::uint8_t* source, std::uint8_t* output,
                bool* left) {
  const std::int32_t last =
      (bounds.rows - 2) * bounds.stride + (bounds.columns - 1) * M::kStep + M::kOwn - M::kFetch;
  if (last < 0) {
    std::fill_n(left, end - begin, true);
    return true;
  }
  bool any = false;
  const Picture picture = {
      source, bounds.stride, hn::Set(Unsigned(), static_cast<std::uint32_t>(last)), {}, format};
  alignas(64) std::int32_t words[kPixels * kRuns];
  for (int j = begin; j < end; j += kRuns) {
    const int runs = std::min(kRuns, end - j);
    const auto made = blend_block<M>(picture, bounds, row, j, nearest, words);
    put_block<M>(words, runs, output + static_cast<std::ptrdiff_t>(j - begin) * kPixels * M::kStep);
    std::fill_n(left + (j - begin), runs, false);
    if (HWY_UNLIKELY(!hn::AllTrue(Unsigned(), made))) {
      alignas(64) std::uint32_t is_made[kRuns];
      hn::Store(hn::VecFromMask(Unsigned(), made), Unsigned(), is_made);
      for (int r = 0; r < runs; ++r) {
        left[j - begin + r] = is_made[r] == 0;
        any = any || is_made[r] == 0;
      }
    }
  }
  return any;
}

bool blend_steep(LaneLayout layout, WordFormat format, const SourceBounds& bounds,
                 const RunRow& row, int begin, int end, bool nearest, const std::uint8_t* source,
                 std::uint8_t* output, bool* left) {
  const auto blend = [&](auto memory) {
    return blend_runs<decltype(memory)>(format, bounds, row, begin, end, nearest, source, output,
                                        left);
  };
  switch (layout) {
    case LaneLayout::kOne:
      return blend(GatheredBytes<1, 1>());
    case LaneLayout::kTwo:
      return blend(GatheredBytes<2, 1>());
    case LaneLayout::kThree:
      return blend(GatheredBytes<3, 1>());
    case LaneLayout::kFour:
      return blend(GatheredBytes<4, 1>());
    case LaneLayout::kOneSpread:
      return blend(GatheredBytes<1, 2>());
    case LaneLayout::kTwoSpread:
      return blend(GatheredBytes<2, 2>());
    case LaneLayout::kOneWord:
      return blend(GatheredWords<1>());
    case LaneLayout::kTwoWords:
      return blend(GatheredWords<2>());
    default:
      std::fill_n(left, end - begin, true);
      return true;
  }
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(blend_steep);

bool blend_steep_runs(LaneLayout layout, WordFormat format, const SourceBounds& bounds,
                      const RunRow& row, int begin, int end, bool nearest,
                      const std::uint8_t* source, std::uint8_t* output, bool* left) noexcept {
  return HWY_DYNAMIC_DISPATCH(blend_steep)(layout, format, bounds, row, begin, end, nearest, source,
                                           output, left);
}

}  // namespace calvin::remap
#endif
