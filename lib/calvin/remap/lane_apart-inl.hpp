// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of pixels of three or four bytes, each of which is fetched by its own
// address: 8 bytes hold it and its neighbour. Compiled once per target of Highway: include it after
// hwy/foreach_target.h.
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

// What is known of the pixels of a block of runs.
struct PixelSamples {
  alignas(64) std::int32_t address[8 * kBlockRuns];
  alignas(64) std::int16_t across[8 * kBlockRuns];
  alignas(64) std::int16_t down[8 * kBlockRuns];
};
template <class P, bool kSteady>
HWY_INLINE void place_pixels(const RowTask& task, int run, hn::Vec<PlaceNumbers<P>> way,
                             Stride stride, int to, PixelSamples& samples) {
  const PlaceNumbers<P> d;
  Both<P> at = places_of<P, kSteady>(task.row, task.band, run, way);
  auto down = down_of<P>(at.y);
  if (task.nearest) {
    at.x = rounded_place(d, at.x);
    // The row behind the nearest one need not be there.
    down = hn::IfThenElseZero(hn::Gt(down, hn::Set(d, 0x3FFF)), hn::Set(d, 0x7FFF));
  }
  store_addresses<P>(at, task.row.offset + run, stride, samples.address + to);
  hn::Store(across_of<P>(at.x), d, samples.across + to);
  hn::Store(down, d, samples.down + to);
}

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
HWY_INLINE hn::Vec<ApartNumbers> blend_two(const std::uint8_t* source, std::int32_t stride,
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

// Eight pixels.
template <int kComponents>
HWY_INLINE void blend_eight(const std::uint8_t* source, std::int32_t stride,
                            const PixelSamples& samples, int first, std::uint8_t* out,
                            const Blender<ApartBytes>& blender) {
  constexpr int kAhead = 5;  // rows of the source that are fetched before they are needed
  const ApartBytes bytes;
  hwy::Prefetch(source + samples.address[first] + static_cast<std::ptrdiff_t>(kAhead) * stride +
                32);
  for (int i = 0; i < 2 / kApartLanes; ++i) {
    const auto a = blend_two<kComponents>(source, stride, samples, first, 2 * i, blender);
    const auto b = blend_two<kComponents>(source, stride, samples, first, 2 * i + 1, blender);
    store_apart<kComponents>(bytes, pack_lanes(bytes, a, b), out + 4 * i * kComponents);
  }
}

template <class P>
HWY_INLINE void place_block(const RowTask& task, int begin, int end, hn::Vec<PlaceNumbers<P>> way,
                            Stride stride, PixelSamples& samples) {
  int to = 0;
  for (int j = begin; j < end; j += P::kSamples / P::kRun, to += P::kSamples) {
    if (HWY_LIKELY(task.row.rows[j] == kSteadyRows)) {
      place_pixels<P, true>(task, j, way, stride, to, samples);
    } else {
      place_pixels<P, false>(task, j, way, stride, to, samples);
    }
  }
}

// As blend_runs(), for runs of `kRun` samples.
template <int kRun, int kComponents>
void blend_apart(const RowTask& task, int begin, int end, const PlaneRows& planes) {
  using P = Placing<kRun, 1, kComponents, true>;
  const Blender<ApartBytes> blender;
  const Stride stride(task.stride, kComponents);
  const auto way = hn::Set(PlaceNumbers<P>(), static_cast<std::int16_t>(task.way * 0x7FFF));
  PixelSamples samples;
  for (int block = begin; block < end; block += kBlockRuns) {
    const int last = std::min(block + kBlockRuns, end);
    place_block<P>(task, block, last, way, stride, samples);
    for (int p = 0; p < planes.planes; ++p) {
      std::uint8_t* out = planes.output[p] + (block - begin) * kRun * kComponents;
      for (int i = 0; i < (last - block) * kRun; i += 8) {
        const int run = block + i / kRun;
        if (HWY_UNLIKELY(task.row.rows[run] >= kSlowGroup)) continue;
        const std::uint8_t* source = planes.source[p] + (kRun < 8 ? 0 : task.row.offset[run]);
        blend_eight<kComponents>(source, task.stride, samples, i, out + i * kComponents, blender);
      }
    }
  }
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
