// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of pixels of three or four bytes, a run at a time, from windows into three
// rows of the source; for machines with vectors of 256 bits. Compiled once per target of Highway:
// include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_WINDOWS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_WINDOWS_INL_HPP
#undef CALVIN_REMAP_WINDOWS_INL_HPP
#else
#define CALVIN_REMAP_WINDOWS_INL_HPP
#endif

#include <algorithm>

#include <hwy/cache_control.h>

#include "calvin/remap/kernels/bilinear/source_coords-inl.hpp"
#include "calvin/remap/kernels/common/blend_math-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Vectors of two lanes at most: to put more lanes together costs more than they save. A lane has
// two of four pixels at a time.
constexpr int kPerPixelLanes = std::min(kLanes, 2);
using PerPixelBytes = hn::FixedTag<std::uint8_t, 16 * kPerPixelLanes>;
using PerPixelNumbers = NumbersOf<PerPixelBytes>;

// How many rows before its use a row of the source is prefetched. To be tuned with
// `tests/bench/run.sh undistort`.
constexpr int kPerPixelAhead = 5;

// The source of a row of the output.
struct PerPixelRow {
  const std::uint8_t* source;
  std::ptrdiff_t stride;
  const Blender<PerPixelBytes>& blender;
};

// Byte shuffles: `neighbours` makes pairs of the components of two pixels and of their right
// neighbours; weights[k] takes, from the weights of eight pixels, those of the `k`th two pixels of
// each lane.
struct PerPixelTables {
  alignas(32) std::uint8_t neighbours[32];
  alignas(32) std::uint8_t weights[4][32];
  alignas(32) std::uint8_t split[2][2][32];  // weights, of either run where VectorLayout::kSplit
  alignas(32) std::uint8_t front[32];        // three of each four bytes
};
constexpr PerPixelTables make_per_pixel_tables(int components) {
  PerPixelTables t{};
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
constexpr PerPixelTables kPerPixelTables = make_per_pixel_tables(kComponents);

// A vector of pixels that are located.
template <class P>
struct PixelVector {
  alignas(32) std::int32_t address[P::kSamples];  // of four components in windows: records of them
  alignas(32) std::int16_t across[P::kSamples];   // as across_of()
  alignas(32) std::int16_t down[P::kSamples];  // weight of the lower row, or of the outer one; 1.15
  alignas(32) std::int16_t bytes[P::kSamples];  // as bytes_of(), of three components in windows
};

// The weights of the `k`th two pixels of each lane, for each of their results. `samples` are the
// weights of eight pixels: the `kPart`th eight of a vector.
template <class P, int kPart>
HWY_INLINE hn::Vec<PerPixelNumbers> weights_of(const std::int16_t* samples, int k) {
  const PerPixelBytes bytes;
  constexpr const PerPixelTables& kTables = kPerPixelTables<P::kStep>;
  const auto* from = reinterpret_cast<const std::uint8_t*>(samples);
  if constexpr (P::kSplit) {
    const auto which = hn::Load(bytes, kTables.split[kPart][k]);
    return hn::BitCast(PerPixelNumbers(),
                       hn::TableLookupBytes(hn::Load(bytes, from - 16 * kPart), which));
  } else {
    const auto which = hn::Load(bytes, kTables.weights[k]);
    return hn::BitCast(PerPixelNumbers(), hn::TableLookupBytes(hn::LoadDup128(bytes, from), which));
  }
}

// Whether a layout can have windows on this machine.
template <class P>
constexpr bool kHasWindows = HWY_ARCH_X86&& HWY_TARGET <= HWY_AVX2&& P::kRun == 8;

// Whether a vector of runs is blended from windows.
template <class P>
HWY_INLINE bool by_windows(const RowTask& task, RunMarks marks) {
  return kHasWindows<P> && has(marks, RunMark::kWindows) && !task.nearest;
}

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
// A pixel of a run in three rows lies between the middle row and the one above it or below it.

// The distance down from the middle row, 1.15. The lowest bit is below the precision of 4.12; set,
// it keeps the number off -1, which has no absolute value in 1.15.
template <class P>
HWY_INLINE hn::Vec<CoordNumbers<P>> down_from_middle(hn::Vec<CoordNumbers<P>> y) {
  const CoordWords<P> words;
  return hn::BitCast(CoordNumbers<P>(), hn::Xor(hn::ShiftLeft<3>(hn::BitCast(words, y)),
                                                in_register(hn::Set(words, 0x8001))));
}

// Blends pairs of neighbours in the middle row and in the outer one.
HWY_INLINE hn::Vec<PerPixelNumbers> blend_rows(const PerPixelRow& row,
                                               hn::Vec<PerPixelBytes> middle,
                                               hn::Vec<PerPixelBytes> outer,
                                               hn::Vec<PerPixelNumbers> across,
                                               hn::Vec<PerPixelNumbers> down) {
  const Blender<PerPixelBytes>& blender = row.blender;
  return blender.rounded(
      blender.between(blender.across(middle, across), blender.across(outer, across), down));
}

// ---- Four components: a permutation of 32-bit numbers takes eight pixels from 32 bytes of a row,
// and another one their right neighbours.

using WindowInts = hn::FixedTag<std::int32_t, 8>;

// Locates a vector of pixels. A record has the column in its bits 12 to 14, and in its sign whether
// the outer row is the one above.
template <class P>
HWY_INLINE void locate_columns(const BothAxes<P>& at, PixelVector<P>& pixels) {
  const CoordNumbers<P> d;
  const WindowInts ints;
  const auto down = down_from_middle<P>(at.y);
  hn::Store(across_of<P>(at.x), d, pixels.across);
  hn::Store(hn::Abs(down), d, pixels.down);
  const auto lower = hn::BitCast(ints, hn::InterleaveLower(at.x, down));
  const auto upper = hn::BitCast(ints, hn::InterleaveUpper(d, at.x, down));
  hn::Store(lower, ints, pixels.address);
  hn::Store(upper, ints, pixels.address + 8);
}

// Eight pixels and their right neighbours.
struct Columns {
  hn::Vec<WindowInts> left;
  hn::Vec<WindowInts> right;
};
HWY_INLINE Columns fetch_columns(const std::uint8_t* row, hn::Vec<WindowInts> columns) {
  const hn::FixedTag<std::uint8_t, 32> bytes;
  // The permutation looks at the lowest three bits of an index only.
  const auto at = [&](const std::uint8_t* window) HWY_ATTR {
    return hn::Vec<WindowInts>{
        _mm256_permutevar8x32_epi32(hn::LoadU(bytes, window).raw, columns.raw)};
  };
  return {at(row), at(row + 4)};
}

// Blends the eight pixels of a vector's `kPart`th run.
template <class P, int kPart>
HWY_INLINE void blend_columns(const PerPixelRow& row, std::int32_t offset,
                              const PixelVector<P>& pixels, std::uint8_t* out) {
  const PerPixelBytes bytes;
  const hn::FixedTag<float, 8> floats;
  const std::uint8_t* source = row.source + offset;
  fetch_ahead(source + kPerPixelAhead * row.stride + 32);
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
  // in_register(): where GCC sees the sign used a second time, it compares with 0 first.
  const auto left = outer(records, above.left, below.left);
  const auto right = outer(in_register(records), above.right, below.right);
  const auto middle_left = hn::BitCast(bytes, middle.left);
  const auto middle_right = hn::BitCast(bytes, middle.right);
  // The first two pixels of each lane, then the other two.
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

// ---- Three components: a lane has eight results of up to four pixels, which lie in 16 bytes of a
// row, from where the run begins or from the lane's first pixel on. Three vectors are two runs,
// each of which has a lane.

// By vector, for the eight results of a lane.
struct ThreeTables {
  // Byte shuffles of the numbers of a run: that of each result's pixel, and that of the lane's
  // first.
  alignas(32) std::uint8_t samples[3][32];
  alignas(32) std::uint8_t firsts[3][32];
  alignas(32) std::int16_t neighbours[3][16];  // byte indices of the sample and its right neighbour
};
// The pixel that the first result of a vector's lane is of.
constexpr int first_of_three(int vector) { return 8 * vector / 3; }
// What bytes_of() gives for the first column.
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
HWY_INLINE void locate_threes(const BothAxes<P>& at, PixelVector<P>& pixels) {
  const CoordNumbers<P> d;
  hn::Store(bytes_of<P>(at.x), d, pixels.bytes);
  hn::Store(across_of<P>(at.x), d, pixels.across);
  hn::Store(down_from_middle<P>(at.y), d, pixels.down);
}

// The pixels of two runs, located: as PixelVector has them.
struct Threes {
  hn::Vec<PerPixelBytes> bytes;
  hn::Vec<PerPixelBytes> across;
  hn::Vec<PerPixelBytes> down;
};
HWY_INLINE hn::Vec<PerPixelNumbers> look_up(hn::Vec<PerPixelBytes> runs,
                                            const std::uint8_t* which) {
  return hn::BitCast(PerPixelNumbers(),
                     hn::TableLookupBytes(runs, hn::Load(PerPixelBytes(), which)));
}

// The byte indices, from where each lane begins, of a vector's results.
template <int kVector>
HWY_INLINE hn::Vec<PerPixelBytes> neighbours_of(const Threes& pixels) {
  auto neighbours = hn::Load(PerPixelNumbers(), kThreeTables.neighbours[kVector]) +
                    look_up(pixels.bytes, kThreeTables.samples[kVector]);
  if constexpr (kVector > 0) {
    neighbours = neighbours - look_up(pixels.bytes, kThreeTables.firsts[kVector]);
  }
  return hn::BitCast(PerPixelBytes(), neighbours);
}

// Blends a vector of results whose two lanes begin at `lower` and `upper` in the first row.
template <int kVector>
HWY_INLINE hn::Vec<PerPixelNumbers> blend_three(const PerPixelRow& row, const std::uint8_t* lower,
                                                const std::uint8_t* upper, const Threes& pixels) {
  const PerPixelBytes bytes;
  const PerPixelNumbers d;
  const hn::FixedTag<std::uint8_t, 16> lane;
  const std::uint8_t* samples = kThreeTables.samples[kVector];
  const auto which = neighbours_of<kVector>(pixels);
  // A lane that is loaded to both halves needs no shuffle, one that is inserted takes an
  // instruction less. Two rows of the one kind and one of the other are the quickest.
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

// Blends the `kVector`th of three vectors of two runs, which begin at `run` and `next`.
template <int kVector, class P>
HWY_INLINE hn::Vec<PerPixelNumbers> blend_part(const PerPixelRow& row, const std::uint8_t* run,
                                               const std::uint8_t* next, const Threes& both,
                                               const PixelVector<P>& pixels) {
  if constexpr (kVector == 0) return blend_three<0>(row, run, next, both);
  const auto* columns = reinterpret_cast<const std::uint8_t*>(pixels.bytes);
  const auto lane_at = [&](const std::uint8_t* from, int pixel)
                           HWY_ATTR { return from + columns[2 * pixel] - (kFirstOfThree & 0xFF); };
  constexpr int kFirst = first_of_three(kVector);
  return blend_three<kVector>(row, lane_at(run, kFirst), lane_at(next, P::kRun + kFirst), both);
}

// Blends two runs.
template <class P>
HWY_INLINE void blend_threes(const PerPixelRow& row, const std::int32_t* offsets,
                             const PixelVector<P>& pixels, std::uint8_t* out) {
  const PerPixelBytes bytes;
  const hn::FixedTag<std::uint8_t, 16> lane;
  const std::uint8_t* run = row.source + offsets[0];
  const std::uint8_t* next = row.source + offsets[1];
  fetch_ahead(run + kPerPixelAhead * row.stride + 32);
  fetch_ahead(next + kPerPixelAhead * row.stride + 32);
  const auto numbers = [&](const std::int16_t* of) HWY_ATTR {
    return hn::Load(bytes, reinterpret_cast<const std::uint8_t*>(of));
  };
  const Threes both = {numbers(pixels.bytes), numbers(pixels.across), numbers(pixels.down)};
  const auto first = blend_part<0>(row, run, next, both, pixels);
  const auto second = blend_part<1>(row, run, next, both, pixels);
  const auto last = blend_part<2>(row, run, next, both, pixels);
  // The first eight bytes of each of these are written over by the next two stores.
  const auto ends = pack_lanes(bytes, last, last);
  hn::StoreU(hn::LowerHalf(ends), lane, out + 8);
  hn::StoreU(hn::UpperHalf(lane, ends), lane, out + 32);
  const auto begins = pack_lanes(bytes, first, second);
  hn::StoreU(hn::LowerHalf(begins), lane, out);
  hn::StoreU(hn::UpperHalf(lane, begins), lane, out + 24);
}

// Locates a vector of pixels.
template <class P>
HWY_INLINE void locate_window(const BothAxes<P>& at, PixelVector<P>& pixels) {
  if constexpr (P::kStep == 4) {
    locate_columns<P>(at, pixels);
  } else {
    locate_threes<P>(at, pixels);
  }
}

// Blends a vector of pixels, which is two runs.
template <class P>
HWY_INLINE void blend_windows(const PerPixelRow& row, const std::int32_t* offsets,
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
