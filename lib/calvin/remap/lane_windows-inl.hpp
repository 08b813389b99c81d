// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of pixels of three or four bytes: runs that are fetched at once, from windows
// into three rows of the source, on machines with vectors of 256 bits. Compiled once per target of
// Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_LANE_WINDOWS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_LANE_WINDOWS_INL_HPP
#undef CALVIN_REMAP_LANE_WINDOWS_INL_HPP
#else
#define CALVIN_REMAP_LANE_WINDOWS_INL_HPP
#endif

#include <algorithm>

#include <hwy/cache_control.h>

#include "calvin/remap/lane_math-inl.hpp"
#include "calvin/remap/lane_samples-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Vectors of two lanes at most: to put more of them together costs more than they save. A lane is
// four pixels, two at a time.
constexpr int kApartLanes = std::min(kLanes, 2);
using ApartBytes = hn::FixedTag<std::uint8_t, 16 * kApartLanes>;
using ApartNumbers = NumbersOf<ApartBytes>;

// Rows of the source that are fetched before they are needed.
constexpr int kApartAhead = 5;

// A row of pixels that is being made.
struct ApartRow {
  const std::uint8_t* source;
  std::ptrdiff_t stride;
  const Blender<ApartBytes>& blender;
};

// Which bytes of two pixels and their neighbours are blended, and which bytes of the weights of
// eight pixels are those of either two of a lane's four.
struct ApartTables {
  alignas(32) std::uint8_t neighbours[32];
  alignas(32) std::uint8_t weights[4][32];
  alignas(32) std::uint8_t split[2][2][32];  // weights of either run of Placing::kSplit
  alignas(32) std::uint8_t front[32];        // three of each four bytes
};
constexpr ApartTables make_apart_tables(int components) {
  ApartTables t{};
  for (int i = 0; i < 32; ++i) {
    const int result = i % 16 / 2;
    const int component = result % 4 < components ? result % 4 : 0;
    t.neighbours[i] = static_cast<std::uint8_t>(result / 4 * 8 + component + i % 2 * components);
    for (int k = 0; k < 4; ++k) {
      const int byte = 2 * (2 * k + result / 4) + i % 2;
      t.weights[k][i] = static_cast<std::uint8_t>((i / 16 * 8 + byte) % 16);
      if (k < 2) {
        t.split[0][k][i] = static_cast<std::uint8_t>(byte);
        t.split[1][k][i] = static_cast<std::uint8_t>(8 + byte);
      }
    }
    t.front[i] = static_cast<std::uint8_t>(i % 16 < 12 ? i % 16 / 3 * 4 + i % 16 % 3 : 0);
  }
  return t;
}
template <int kComponents>
constexpr ApartTables kApartTables = make_apart_tables(kComponents);

// What is known of the pixels of a vector.
template <class P>
struct PixelVector {
  alignas(32) std::int32_t address[P::kSamples];  // of pixels by windows: their records
  alignas(32) std::int16_t across[P::kSamples];
  alignas(32) std::int16_t down[P::kSamples];
  alignas(32) std::int16_t bytes[P::kSamples];  // of pixels of three components by windows
};

// The weights of the `k`th two pixels of each lane, for each of their results; `samples` are eight,
// or the `kPart`th eight of a vector.
template <class P, int kPart>
HWY_INLINE hn::Vec<ApartNumbers> weights_of(const std::int16_t* samples, int k) {
  const ApartBytes bytes;
  constexpr const ApartTables& kTables = kApartTables<P::kStep>;
  const auto* from = reinterpret_cast<const std::uint8_t*>(samples);
  if constexpr (P::kSplit) {
    const auto which = hn::Load(bytes, kTables.split[kPart][k]);
    return hn::BitCast(ApartNumbers(),
                       hn::TableLookupBytes(hn::Load(bytes, from - 16 * kPart), which));
  } else {
    const auto which = hn::Load(bytes, kTables.weights[k]);
    return hn::BitCast(ApartNumbers(), hn::TableLookupBytes(hn::LoadDup128(bytes, from), which));
  }
}

// Whether there are windows.
template <class P>
constexpr bool kHasWindows = HWY_ARCH_X86&& HWY_TARGET <= HWY_AVX2&& P::kRun == 8;

// Whether a vector of runs is fetched from them.
template <class P>
HWY_INLINE bool by_windows(const RowTask& task, std::int32_t mark) {
  return kHasWindows<P> && is_window(mark) && !task.nearest;
}

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
// Runs in three rows: a pixel lies between the middle one and the one above or below.

// From the middle row, 1.15; the lowest bit, which has no meaning, keeps it off -1.
template <class P>
HWY_INLINE hn::Vec<PlaceNumbers<P>> down_from_middle(hn::Vec<PlaceNumbers<P>> y) {
  const PlaceWords<P> words;
  return hn::BitCast(PlaceNumbers<P>(), hn::Xor(hn::ShiftLeft<3>(hn::BitCast(words, y)),
                                                kept(hn::Set(words, 0x8001))));
}

// Pairs of neighbours in the middle row and in the other one, to results.
HWY_INLINE hn::Vec<ApartNumbers> blend_rows(const ApartRow& row, hn::Vec<ApartBytes> middle,
                                            hn::Vec<ApartBytes> outer, hn::Vec<ApartNumbers> across,
                                            hn::Vec<ApartNumbers> down) {
  const Blender<ApartBytes>& blender = row.blender;
  return blender.rounded(
      blender.between(blender.across(middle, across), blender.across(outer, across), down));
}

// ---- Four components: a permutation of 32 bits takes eight pixels from 32 bytes of a row, another
// one their neighbours.

using WindowInts = hn::FixedTag<std::int32_t, 8>;

// A record has a column in bits 12 to 14, and a sign.
template <class P>
HWY_INLINE void place_columns(const Both<P>& at, PixelVector<P>& pixels) {
  const PlaceNumbers<P> d;
  const WindowInts ints;
  const auto down = down_from_middle<P>(at.y);
  hn::Store(across_of<P>(at.x), d, pixels.across);
  hn::Store(hn::Abs(down), d, pixels.down);
  const auto lower = hn::BitCast(ints, hn::InterleaveLower(at.x, down));
  const auto upper = hn::BitCast(ints, hn::InterleaveUpper(d, at.x, down));
  hn::Store(lower, ints, pixels.address);
  hn::Store(upper, ints, pixels.address + 8);
}

// Eight pixels and their neighbours.
struct Columns {
  hn::Vec<WindowInts> left;
  hn::Vec<WindowInts> right;
};
HWY_INLINE Columns fetch_columns(const std::uint8_t* row, hn::Vec<WindowInts> columns) {
  const hn::FixedTag<std::uint8_t, 32> bytes;
  // It heeds three bits of an index.
  const auto at = [&](const std::uint8_t* window) HWY_ATTR {
    return hn::Vec<WindowInts>{
        _mm256_permutevar8x32_epi32(hn::LoadU(bytes, window).raw, columns.raw)};
  };
  return {at(row), at(row + 4)};
}

// The eight pixels of a vector's `kPart`th run.
template <class P, int kPart>
HWY_INLINE void blend_columns(const ApartRow& row, std::int32_t offset,
                              const PixelVector<P>& pixels, std::uint8_t* out) {
  const ApartBytes bytes;
  const hn::FixedTag<float, 8> floats;
  const std::uint8_t* source = row.source + offset;
  fetch_ahead(source + kApartAhead * row.stride + 32);
  constexpr int kFirst = 8 * kPart;
  const auto records = hn::Load(WindowInts(), pixels.address + kFirst);
  const auto columns = hn::ShiftRight<12>(records);
  const Columns above = fetch_columns(source, columns);
  const Columns middle = fetch_columns(source + row.stride, columns);
  const Columns below = fetch_columns(source + 2 * row.stride, columns);
  const auto outer = [&](hn::Vec<WindowInts> which, hn::Vec<WindowInts> a,
                         hn::Vec<WindowInts> b) HWY_ATTR {
    return hn::BitCast(bytes,
                       hn::IfNegativeThenElse(hn::BitCast(floats, which), hn::BitCast(floats, a),
                                              hn::BitCast(floats, b)));
  };
  // GCC takes a sign as it is once; for a second use it compares.
  const auto left = outer(records, above.left, below.left);
  const auto right = outer(kept(records), above.right, below.right);
  const auto middle_left = hn::BitCast(bytes, middle.left);
  const auto middle_right = hn::BitCast(bytes, middle.right);
  // Each lane's first two pixels, and its others.
  const auto results = [&](auto near, auto far, int half) HWY_ATTR {
    return blend_rows(row, near, far, weights_of<P, kPart>(pixels.across + kFirst, half),
                      weights_of<P, kPart>(pixels.down + kFirst, half));
  };
  const auto lower =
      results(hn::InterleaveLower(middle_left, middle_right), hn::InterleaveLower(left, right), 0);
  const auto upper = results(hn::InterleaveUpper(bytes, middle_left, middle_right),
                             hn::InterleaveUpper(bytes, left, right), 1);
  hn::StoreU(pack_lanes(bytes, lower, upper), bytes, out);
}
// ---- Three components: a lane is eight results, of up to four pixels, which 16 bytes of a row
// hold, from where the run begins or from the lane's first pixel on. Three vectors are two runs,
// each of which has a lane.

struct ThreeTables {
  // Bytes of the numbers of a run: of each result's pixel, and of the lane's first one.
  alignas(32) std::uint8_t samples[3][32];
  alignas(32) std::uint8_t firsts[3][32];
  alignas(32) std::int16_t neighbours[3][16];  // bytes of the sample in a pixel and the next one
};
constexpr int first_of_three(int vector) { return 8 * vector / 3; }
// What bytes_of() has for the first column.
constexpr int kFirstOfThree = (0x0FFF * 0x3030) >> 16;
constexpr ThreeTables make_three_tables() {
  ThreeTables t{};
  for (int v = 0; v < 3; ++v) {
    for (int i = 0; i < 16; ++i) {
      const int result = 8 * v + i % 8;
      for (int b = 0; b < 2; ++b) {
        t.samples[v][2 * i + b] = static_cast<std::uint8_t>(2 * (result / 3) + b);
        t.firsts[v][2 * i + b] = static_cast<std::uint8_t>(2 * first_of_three(v) + b);
      }
      const int before = v == 0 ? kFirstOfThree : 0;
      t.neighbours[v][i] = static_cast<std::int16_t>(result % 3 * 0x101 + 0x300 - before);
    }
  }
  return t;
}
constexpr ThreeTables kThreeTables = make_three_tables();

template <class P>
HWY_INLINE void place_threes(const Both<P>& at, PixelVector<P>& pixels) {
  const PlaceNumbers<P> d;
  hn::Store(bytes_of<P>(at.x), d, pixels.bytes);
  hn::Store(across_of<P>(at.x), d, pixels.across);
  hn::Store(down_from_middle<P>(at.y), d, pixels.down);
}

// What is known of the pixels of two runs.
struct Threes {
  hn::Vec<ApartBytes> bytes;
  hn::Vec<ApartBytes> across;
  hn::Vec<ApartBytes> down;
};
HWY_INLINE hn::Vec<ApartNumbers> look_up(hn::Vec<ApartBytes> runs, const std::uint8_t* which) {
  return hn::BitCast(ApartNumbers(), hn::TableLookupBytes(runs, hn::Load(ApartBytes(), which)));
}

// Which bytes from the beginning of each lane a vector's results are made of.
template <int kVector>
HWY_INLINE hn::Vec<ApartBytes> neighbours_of(const Threes& pixels) {
  auto neighbours = hn::Load(ApartNumbers(), kThreeTables.neighbours[kVector]) +
                    look_up(pixels.bytes, kThreeTables.samples[kVector]);
  if constexpr (kVector > 0) {
    neighbours = neighbours - look_up(pixels.bytes, kThreeTables.firsts[kVector]);
  }
  return hn::BitCast(ApartBytes(), neighbours);
}

// A vector of results, from where each of its lanes begins in the first row.
template <int kVector>
HWY_INLINE hn::Vec<ApartNumbers> blend_three(const ApartRow& row, const std::uint8_t* lower,
                                             const std::uint8_t* upper, const Threes& pixels) {
  const ApartBytes bytes;
  const ApartNumbers d;
  const hn::FixedTag<std::uint8_t, 16> lane;
  const std::uint8_t* samples = kThreeTables.samples[kVector];
  const auto which = neighbours_of<kVector>(pixels);
  // Lanes that are loaded to both halves leave the port of the shuffles alone, one that is inserted
  // takes an instruction less; some of each is the quickest.
  const auto load = [&](std::ptrdiff_t at) HWY_ATTR {
    return hn::ConcatUpperLower(bytes, hn::LoadDup128(bytes, upper + at),
                                hn::LoadDup128(bytes, lower + at));
  };
  const auto above = hn::TableLookupBytes(load(0), which);
  const auto below = hn::TableLookupBytes(load(2 * row.stride), which);
  const auto middle = hn::TableLookupBytes(
      hn::Combine(bytes, hn::LoadU(lane, upper + row.stride), hn::LoadU(lane, lower + row.stride)),
      which);
  const auto down = look_up(pixels.down, samples);
  const auto is_above = hn::MaskFromVec(hn::BroadcastSignBit(down));
  const auto outer = hn::IfThenElse(is_above, hn::BitCast(d, above), hn::BitCast(d, below));
  return blend_rows(row, middle, hn::BitCast(bytes, outer), look_up(pixels.across, samples),
                    hn::Abs(down));
}

// The `kVector`th of three vectors of two runs, which begin at `run` and `next`.
template <int kVector, class P>
HWY_INLINE hn::Vec<ApartNumbers> blend_part(const ApartRow& row, const std::uint8_t* run,
                                            const std::uint8_t* next, const Threes& both,
                                            const PixelVector<P>& pixels) {
  if constexpr (kVector == 0) return blend_three<0>(row, run, next, both);
  const auto* columns = reinterpret_cast<const std::uint8_t*>(pixels.bytes);
  const auto lane_at = [&](const std::uint8_t* from, int pixel)
                           HWY_ATTR { return from + columns[2 * pixel] - (kFirstOfThree & 0xFF); };
  constexpr int kFirst = first_of_three(kVector);
  return blend_three<kVector>(row, lane_at(run, kFirst), lane_at(next, P::kRun + kFirst), both);
}

// Two runs.
template <class P>
HWY_INLINE void blend_threes(const ApartRow& row, const std::int32_t* offsets,
                             const PixelVector<P>& pixels, std::uint8_t* out) {
  const ApartBytes bytes;
  const hn::FixedTag<std::uint8_t, 16> lane;
  const std::uint8_t* run = row.source + offsets[0];
  const std::uint8_t* next = row.source + offsets[1];
  fetch_ahead(run + kApartAhead * row.stride + 32);
  fetch_ahead(next + kApartAhead * row.stride + 32);
  const auto numbers = [&](const std::int16_t* of) HWY_ATTR {
    return hn::Load(bytes, reinterpret_cast<const std::uint8_t*>(of));
  };
  const Threes both = {numbers(pixels.bytes), numbers(pixels.across), numbers(pixels.down)};
  const auto first = blend_part<0>(row, run, next, both, pixels);
  const auto amid = blend_part<1>(row, run, next, both, pixels);
  const auto last = blend_part<2>(row, run, next, both, pixels);
  // What is before a run's last eight bytes is written over.
  const auto ends = pack_lanes(bytes, last, last);
  hn::StoreU(hn::LowerHalf(ends), lane, out + 8);
  hn::StoreU(hn::UpperHalf(lane, ends), lane, out + 32);
  const auto begins = pack_lanes(bytes, first, amid);
  hn::StoreU(hn::LowerHalf(begins), lane, out);
  hn::StoreU(hn::UpperHalf(lane, begins), lane, out + 24);
}

// A vector of pixels.
template <class P>
HWY_INLINE void place_window(const Both<P>& at, PixelVector<P>& pixels) {
  if constexpr (P::kStep == 4) {
    place_columns<P>(at, pixels);
  } else {
    place_threes<P>(at, pixels);
  }
}

// Two runs.
template <class P>
HWY_INLINE void blend_windows(const ApartRow& row, const std::int32_t* offsets,
                              const PixelVector<P>& pixels, std::uint8_t* out) {
  if constexpr (P::kStep == 4) {
    blend_columns<P, 0>(row, offsets[0], pixels, out);
    blend_columns<P, 1>(row, offsets[1], pixels, out + 32);
  } else {
    blend_threes(row, offsets, pixels, out);
  }
}
#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
