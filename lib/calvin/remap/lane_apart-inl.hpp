// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of pixels of three or four bytes, each of which is fetched by its own
// address: 8 bytes hold it and its neighbour. Where 32 bits can be moved to anywhere in 32 bytes,
// most runs of four-byte pixels are fetched at once instead. Compiled once per target of Highway:
// include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_LANE_APART_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_LANE_APART_INL_HPP
#undef CALVIN_REMAP_LANE_APART_INL_HPP
#else
#define CALVIN_REMAP_LANE_APART_INL_HPP
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
  alignas(32) std::uint8_t front[32];  // three of each four bytes
};
constexpr ApartTables make_apart_tables(int components) {
  ApartTables t{};
  for (int i = 0; i < 32; ++i) {
    const int result = i % 16 / 2;
    const int component = result % 4 < components ? result % 4 : 0;
    t.neighbours[i] = static_cast<std::uint8_t>(result / 4 * 8 + component + i % 2 * components);
    for (int k = 0; k < 4; ++k) {
      t.weights[k][i] =
          static_cast<std::uint8_t>((2 * (i / 16 * 4 + 2 * k + result / 4) + i % 2) % 16);
    }
    t.front[i] = static_cast<std::uint8_t>(i % 16 < 12 ? i % 16 / 3 * 4 + i % 16 % 3 : 0);
  }
  return t;
}
template <int kComponents>
constexpr ApartTables kApartTables = make_apart_tables(kComponents);

// 16 bytes for each lane, from the first address of each four.
template <class D>
HWY_INLINE hn::Vec<D> load_lanes(D d, const std::uint8_t* source, const std::int32_t* addresses) {
  const hn::FixedTag<std::uint8_t, 16> lane;
  const auto first = hn::LoadU(lane, source + addresses[0]);
  if constexpr (hn::MaxLanes(D()) == 16) {
    return first;
  } else {
    return hn::Combine(d, hn::LoadU(lane, source + addresses[4]), first);
  }
}

// Two pixels of each lane, which are the first ones of four, blended across.
template <int kComponents>
HWY_INLINE hn::Vec<ApartNumbers> blend_across(const std::uint8_t* source,
                                              const std::int32_t* addresses,
                                              hn::Vec<ApartNumbers> across,
                                              const Blender<ApartBytes>& blender) {
  const ApartBytes bytes;
  const hn::Repartition<std::uint64_t, ApartBytes> halves;
  const auto both =
      hn::InterleaveLower(halves, hn::BitCast(halves, load_lanes(bytes, source, addresses)),
                          hn::BitCast(halves, load_lanes(bytes, source, addresses + 1)));
  const auto which = hn::Load(bytes, kApartTables<kComponents>.neighbours);
  return blender.across(hn::TableLookupBytes(hn::BitCast(bytes, both), which), across);
}

// What is known of the pixels of a block of runs. To know it of many before the first one is
// blended keeps the machine busy: it cannot look as far ahead as one takes.
struct PixelSamples {
  alignas(64) std::int32_t address[8 * kBlockRuns];  // of pixels by windows: their records
  alignas(64) std::int16_t across[8 * kBlockRuns];
  alignas(64) std::int16_t down[8 * kBlockRuns];
  bool by_window[kBlockRuns];  // by the first run of a vector
};
// The weights of the `k`th two pixels of each lane, for each of their results; `samples` are eight.
template <int kComponents>
HWY_INLINE hn::Vec<ApartNumbers> weights_of(const std::int16_t* samples, int k) {
  const ApartBytes bytes;
  const auto all = hn::LoadDup128(bytes, reinterpret_cast<const std::uint8_t*>(samples));
  const auto which = hn::Load(bytes, kApartTables<kComponents>.weights[k]);
  return hn::BitCast(ApartNumbers(), hn::TableLookupBytes(all, which));
}

// The values of the `k`th two pixels of each lane, of the eight pixels from `first` on.
template <int kComponents>
HWY_INLINE hn::Vec<ApartNumbers> blend_two(const std::uint8_t* source, std::ptrdiff_t stride,
                                           const PixelSamples& samples, int first, int k,
                                           const Blender<ApartBytes>& blender) {
  const std::int32_t* addresses = samples.address + first + 2 * k;
  const auto across = weights_of<kComponents>(samples.across + first, k);
  const auto upper = blend_across<kComponents>(source, addresses, across, blender);
  const auto lower = blend_across<kComponents>(source + stride, addresses, across, blender);
  return blender.rounded(
      blender.between(upper, lower, weights_of<kComponents>(samples.down + first, k)));
}

template <int kComponents, class D>
HWY_INLINE void store_apart(D d, hn::Vec<D> pixels, std::uint8_t* out) {
  if constexpr (kComponents == 4) {
    hn::StoreU(pixels, d, out);
  } else {
    const auto front = hn::TableLookupBytes(pixels, hn::Load(d, kApartTables<kComponents>.front));
    const hn::FixedTag<std::uint8_t, 16> lane;
    if constexpr (hn::MaxLanes(D()) == 16) {
      hn::StoreU(front, lane, out);
    } else {
      // What is behind a lane's twelve bytes is written over.
      hn::StoreU(hn::LowerHalf(front), lane, out);
      hn::StoreU(hn::UpperHalf(lane, front), lane, out + 12);
    }
  }
}

// Eight pixels from `first` on.
template <int kComponents>
HWY_INLINE void blend_eight(const ApartRow& row, std::int32_t offset, const PixelSamples& samples,
                            int first, std::uint8_t* out) {
  const ApartBytes bytes;
  const std::uint8_t* source = row.source + offset;
  hwy::Prefetch(source + samples.address[first] + kApartAhead * row.stride + 32);
  for (int i = 0; i < 2 / kApartLanes; ++i) {
    const auto a = blend_two<kComponents>(source, row.stride, samples, first, 2 * i, row.blender);
    const auto b =
        blend_two<kComponents>(source, row.stride, samples, first, 2 * i + 1, row.blender);
    store_apart<kComponents>(bytes, pack_lanes(bytes, a, b), out + 4 * i * kComponents);
  }
}

// A vector of pixels that are fetched one by one.
template <class P>
HWY_INLINE void store_pixels(Both<P> at, const std::int32_t* offsets, Stride stride, bool nearest,
                             int to, PixelSamples& samples) {
  const PlaceNumbers<P> d;
  auto down = down_of<P>(at.y);
  if (nearest) {
    at.x = rounded_place(d, at.x);
    // The row behind the nearest one need not be there.
    down = hn::IfThenElseZero(hn::Gt(down, hn::Set(d, 0x3FFF)), hn::Set(d, 0x7FFF));
  }
  store_addresses<P>(at, offsets, stride, samples.address + to);
  hn::Store(across_of<P>(at.x), d, samples.across + to);
  hn::Store(down, d, samples.down + to);
}

// Whether there are permutations of 32 bits.
template <class P>
constexpr bool kByColumns = HWY_ARCH_X86&& HWY_TARGET <= HWY_AVX2&& P::kRun == 8 && P::kStep == 4;

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
// ---- Runs whose pixels lie in eight columns and three rows are fetched as a whole: one
// permutation takes eight pixels from a row, another one their neighbours.

using WindowInts = hn::FixedTag<std::int32_t, 8>;

// Whether all of a vector of pixels are such.
template <class P>
HWY_INLINE bool fit_windows(const Both<P>& at) {
  const PlaceWords<P> words;
  const auto rows = hn::SaturatedAdd(hn::BitCast(words, at.y), kept(hn::Set(words, 0x6000)));
  const auto too_far = hn::Or(hn::BitCast(words, at.x), rows);
  return (_mm256_movemask_epi8(too_far.raw) & 0xAAAAAAAAU) == 0;
}

// A record has a column in bits 12 to 14, and a sign: whether the pixel lies above the middle one
// of the three rows, or below.
template <class P>
HWY_INLINE void store_windows(const Both<P>& at, int to, PixelSamples& samples) {
  const PlaceNumbers<P> d;
  const PlaceWords<P> words;
  const WindowInts ints;
  // From the middle row, 1.15; the lowest bit, which has no meaning, keeps it off -1.
  const auto down = hn::BitCast(
      d, hn::Xor(hn::ShiftLeft<3>(hn::BitCast(words, at.y)), kept(hn::Set(words, 0x8001))));
  hn::Store(across_of<P>(at.x), d, samples.across + to);
  hn::Store(hn::Abs(down), d, samples.down + to);
  const auto lower = hn::BitCast(ints, hn::InterleaveLower(at.x, down));
  const auto upper = hn::BitCast(ints, hn::InterleaveUpper(d, at.x, down));
  hn::Store(hn::ConcatLowerLower(ints, upper, lower), ints, samples.address + to);
  hn::Store(hn::ConcatUpperUpper(ints, upper, lower), ints, samples.address + to + 8);
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

// A run's eight pixels, from `first` on.
HWY_INLINE void blend_window(const ApartRow& row, std::int32_t offset, const PixelSamples& samples,
                             int first, std::uint8_t* out) {
  const ApartBytes bytes;
  const hn::FixedTag<float, 8> floats;
  const std::uint8_t* source = row.source + offset;
  hwy::Prefetch(source + kApartAhead * row.stride + 32);
  const auto records = hn::Load(WindowInts(), samples.address + first);
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
    const auto across = weights_of<4>(samples.across + first, half);
    return row.blender.rounded(row.blender.between(row.blender.across(near, across),
                                                   row.blender.across(far, across),
                                                   weights_of<4>(samples.down + first, half)));
  };
  const auto lower =
      results(hn::InterleaveLower(middle_left, middle_right), hn::InterleaveLower(left, right), 0);
  const auto upper = results(hn::InterleaveUpper(bytes, middle_left, middle_right),
                             hn::InterleaveUpper(bytes, left, right), 1);
  hn::StoreU(pack_lanes(bytes, lower, upper), bytes, out);
}
#endif

// A vector of steady runs; whether they are fetched by windows.
template <class P>
HWY_INLINE bool place_steady(const RowTask& task, int run, hn::Vec<PlaceNumbers<P>> way,
                             Stride stride, int to, PixelSamples& samples) {
  const Both<P> at = places_of<P, true>(task.row, task.band, run, way);
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (kByColumns<P>) {
    if (HWY_LIKELY(!task.nearest && fit_windows<P>(at))) {
      store_windows<P>(at, to, samples);
      return true;
    }
  }
#endif
  store_pixels<P>(at, task.row.offset + run, stride, task.nearest, to, samples);
  return false;
}

template <class P>
HWY_INLINE void place_block(const RowTask& task, int begin, int end, hn::Vec<PlaceNumbers<P>> way,
                            Stride stride, PixelSamples& samples) {
  int to = 0;
  for (int j = begin; j < end; j += P::kSamples / P::kRun, to += P::kSamples) {
    if (HWY_LIKELY(task.row.rows[j] == kSteadyRows)) {
      samples.by_window[j - begin] = place_steady<P>(task, j, way, stride, to, samples);
    } else {
      samples.by_window[j - begin] = false;
      store_pixels<P>(places_of<P, false>(task.row, task.band, j, way), task.row.offset + j, stride,
                      task.nearest, to, samples);
    }
  }
}

// The runs from `begin` to before `end`, whose pixels are known.
template <class P>
HWY_INLINE void blend_block(const ApartRow& row, const RunRow& runs, int begin, int end,
                            const PixelSamples& samples, std::uint8_t* out) {
  const std::int32_t* marks = runs.rows + begin;
  const std::int32_t* offsets = runs.offset + begin;
  constexpr int kRuns = P::kSamples / P::kRun;
  // A vector is a group or a part of one.
  for (int j = 0; j < end - begin; j += kRuns, out += P::kSamples * P::kStep) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
    if constexpr (kByColumns<P>) {
      if (HWY_LIKELY(samples.by_window[j])) {
        blend_window(row, offsets[j], samples, 8 * j, out);
        blend_window(row, offsets[j + 1], samples, 8 * j + 8, out + 32);
        continue;
      }
    }
#endif
    if (HWY_UNLIKELY(marks[j] >= kSlowGroup)) continue;
    for (int i = 0; i < P::kSamples; i += 8) {
      blend_eight<P::kStep>(row, P::kRun < 8 ? 0 : offsets[j + i / P::kRun], samples,
                            j * P::kRun + i, out + i * P::kStep);
    }
  }
}

// As blend_runs(), for runs of `kRun` samples.
template <int kRun, int kComponents>
void blend_apart(const RowTask& shared, int begin, int end, const PlaneRows& planes) {
  using P = Placing<kRun, 1, kComponents, true>;
  // What is written may be anything for all that the compiler knows.
  const RowTask task = shared;
  const Blender<ApartBytes> blender;
  const Stride stride(task.stride, kComponents);
  const auto way = hn::Set(PlaceNumbers<P>(), static_cast<std::int16_t>(task.way * 0x7FFF));
  PixelSamples samples;
  for (int p = 0; p < planes.planes; ++p) {
    const ApartRow row = {planes.source[p], task.stride, blender};
    std::uint8_t* out = planes.output[p];
    for (int block = begin; block < end; block += kBlockRuns) {
      const int last = std::min(block + kBlockRuns, end);
      place_block<P>(task, block, last, way, stride, samples);
      blend_block<P>(row, task.row, block, last, samples, out);
      out += kBlockRuns * kRun * kComponents;
    }
  }
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
