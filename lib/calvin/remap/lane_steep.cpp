// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of 8-bit samples along lines of any slope, for every instruction set: each
// pixel is fetched by its own address together with its neighbour, and as many of them as fill 128
// bits are blended at a time. For runs whose samples lie too far apart for the other kernels: much
// smaller outputs, wide views.

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_steep.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_math-inl.hpp"
#include "calvin/remap/lane_places-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

int blend_steep(LaneLayout /*layout*/, const SourceBounds& /*bounds*/, const RunRow& /*row*/,
                int begin, int /*end*/, bool /*nearest*/, const std::uint8_t* /*source*/,
                std::uint8_t* /*output*/) {
  return begin;
}

#else

using Lane = hn::FixedTag<std::uint8_t, 16>;
using LaneNumbers = NumbersOf<Lane>;

// Pixels of components that are `kSpacing` bytes apart.
template <int kComponents, int kSpacing>
struct Steep {
  static constexpr int kPixelStep = kComponents * kSpacing;
  // Bytes that are fetched for a pixel: it and its neighbour.
  static constexpr int kFetch = kPixelStep > 2 ? 8 : 2 * kPixelStep;
  static constexpr int kSet = 16 / kFetch;             // pixels at a time
  static constexpr int kResults = kSet * kComponents;  // of eight
  // Columns at the end of a row whose bytes reach beyond it.
  static constexpr int kSpare = kSpacing > 1 || kComponents == 3 ? 1 : 0;
};

// Which bytes of a set are blended, and which bytes of the weights of eight pixels are its own.
struct SteepTables {
  alignas(16) std::uint8_t neighbours[16];
  alignas(16) std::uint8_t weights[kPixels][16];
};
template <int kComponents, int kSpacing>
constexpr SteepTables make_steep_tables() {
  using S = Steep<kComponents, kSpacing>;
  SteepTables t{};
  for (int i = 0; i < 16; ++i) {
    const int result = i / 2 < S::kResults ? i / 2 : 0;
    const int pixel = result / kComponents;
    const int first = pixel * S::kFetch + result % kComponents * kSpacing;
    t.neighbours[i] = static_cast<std::uint8_t>(first + i % 2 * S::kPixelStep);
    for (int set = 0; set < kPixels / S::kSet; ++set) {
      t.weights[set][i] = static_cast<std::uint8_t>(2 * (set * S::kSet + pixel) + i % 2);
    }
  }
  return t;
}
template <int kComponents, int kSpacing>
constexpr SteepTables kSteepTables = make_steep_tables<kComponents, kSpacing>();

// What is known of a run's pixels.
struct SteepRun {
  alignas(32) std::int32_t offsets[kPixels];
  alignas(16) std::int16_t across[kPixels];  // as Blender::across() has it
  alignas(16) std::int16_t down[kPixels];    // 1.15
};

// False where a pixel has no neighbour in the source.
template <class S>
HWY_INLINE bool place_run(const RunRow& row, int run, const SourceBounds& bounds, bool nearest,
                          SteepRun& to) {
  const PlaceFloats d;
  const PlaceInts ints;
  const hn::Rebind<std::int16_t, PlaceInts> numbers;
  const RunCurve px(row.x + run);
  const RunCurve py(row.y + run);
  const auto number = [&](hn::Vec<PlaceFloats> value) HWY_ATTR {
    return hn::DemoteTo(numbers, hn::NearestInt(hn::Min(value, hn::Set(d, 32767))));
  };
  for (int i = 0; i < kPixels; i += static_cast<int>(hn::MaxLanes(d))) {
    const RunPlaces x = places_at(px, i, nearest);
    const RunPlaces y = places_at(py, i, nearest);
    if (HWY_UNLIKELY(!are_within(x, 0, 1, bounds.last_column - S::kSpare) ||
                     !are_within(y, 0, 1, bounds.last_row))) {
      return false;
    }
    hn::StoreU(y.whole * hn::Set(ints, bounds.stride) + x.whole * hn::Set(ints, S::kPixelStep),
               ints, to.offsets + i);
    hn::StoreU(number(hn::MulSub(x.rest, hn::Set(d, 65536), hn::Set(d, 32768))), numbers,
               to.across + i);
    hn::StoreU(number(y.rest * hn::Set(d, 32768)), numbers, to.down + i);
  }
  return true;
}

// The pixels of half a set, one behind the other.
template <class S>
HWY_INLINE std::uint64_t fetch_half(const std::uint8_t* source, const std::int32_t* offsets) {
  std::uint64_t all = 0;
  HWY_UNROLL(4)
  for (int i = 0; i < S::kSet / 2; ++i) {
    std::uint64_t pixel = 0;
    std::memcpy(&pixel, source + offsets[i], S::kFetch);
    all |= pixel << (8 * S::kFetch * i % 64);
  }
  return all;
}

template <class S>
HWY_INLINE hn::Vec<Lane> fetch_set(const std::uint8_t* source, const std::int32_t* offsets) {
  const hn::Repartition<std::uint64_t, Lane> d;
  return hn::BitCast(Lane(),
                     hn::InterleaveLower(hn::Set(d, fetch_half<S>(source, offsets)),
                                         hn::Set(d, fetch_half<S>(source, offsets + S::kSet / 2))));
}

// A run whose pixels are placed.
template <int kComponents, int kSpacing>
HWY_INLINE void blend_run(const SteepRun& pixels, const std::uint8_t* source, std::int32_t stride,
                          std::uint8_t* output, const Blender<Lane>& blender) {
  using S = Steep<kComponents, kSpacing>;
  constexpr const SteepTables& kTables = kSteepTables<kComponents, kSpacing>;
  const Lane d;
  const LaneNumbers numbers;
  const auto which = hn::Load(d, kTables.neighbours);
  const auto weights = [&](const std::int16_t* of_run, int set) HWY_ATTR {
    const auto all = hn::BitCast(d, hn::Load(numbers, of_run));
    return hn::BitCast(numbers, hn::TableLookupBytes(all, hn::Load(d, kTables.weights[set])));
  };
  for (int set = 0; set < kPixels / S::kSet; ++set) {
    const std::int32_t* offsets = pixels.offsets + set * S::kSet;
    const auto across = weights(pixels.across, set);
    const auto row_at = [&](const std::uint8_t* from) HWY_ATTR {
      return blender.across(hn::TableLookupBytes(fetch_set<S>(from, offsets), which), across);
    };
    const auto sum =
        blender.between(row_at(source), row_at(source + stride), weights(pixels.down, set));
    const auto rounded = blender.rounded(sum);
    alignas(16) std::uint8_t results[16];
    hn::Store(pack_lanes(d, rounded, rounded), d, results);
    if constexpr (kSpacing == 1) {
      std::memcpy(output + set * S::kResults, results, S::kResults);
    } else {
      for (int i = 0; i < S::kResults; ++i) {
        output[(set * S::kResults + i) * kSpacing] = results[i];
      }
    }
  }
}

template <int kComponents, int kSpacing>
int blend_runs(const SourceBounds& bounds, const RunRow& row, int begin, int end, bool nearest,
               const std::uint8_t* source, std::uint8_t* output) {
  using S = Steep<kComponents, kSpacing>;
  const Blender<Lane> blender;
  SteepRun pixels;
  int run = begin;
  for (; run < end && place_run<S>(row, run, bounds, nearest, pixels); ++run) {
    // The next runs' lines, which go on as this one does.
    const std::ptrdiff_t along = pixels.offsets[kPixels - 1] - pixels.offsets[0];
    for (const std::ptrdiff_t ahead : {3 * along, 4 * along}) {
      hwy::Prefetch(source + pixels.offsets[0] + ahead);
      hwy::Prefetch(source + pixels.offsets[0] + ahead + bounds.stride);
    }
    blend_run<kComponents, kSpacing>(pixels, source, bounds.stride,
                                     output + (run - begin) * kPixels * S::kPixelStep, blender);
  }
  return run;
}

int blend_steep(LaneLayout layout, const SourceBounds& bounds, const RunRow& row, int begin,
                int end, bool nearest, const std::uint8_t* source, std::uint8_t* output) {
  switch (layout) {
    case LaneLayout::kOne:
      return blend_runs<1, 1>(bounds, row, begin, end, nearest, source, output);
    case LaneLayout::kTwo:
      return blend_runs<2, 1>(bounds, row, begin, end, nearest, source, output);
    case LaneLayout::kThree:
      return blend_runs<3, 1>(bounds, row, begin, end, nearest, source, output);
    case LaneLayout::kFour:
      return blend_runs<4, 1>(bounds, row, begin, end, nearest, source, output);
    case LaneLayout::kOneSpread:
      return blend_runs<1, 2>(bounds, row, begin, end, nearest, source, output);
    case LaneLayout::kTwoSpread:
      return blend_runs<2, 2>(bounds, row, begin, end, nearest, source, output);
    default:
      return begin;
  }
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(blend_steep);

int blend_steep_runs(LaneLayout layout, const SourceBounds& bounds, const RunRow& row, int begin,
                     int end, bool nearest, const std::uint8_t* source,
                     std::uint8_t* output) noexcept {
  return HWY_DYNAMIC_DISPATCH(blend_steep)(layout, bounds, row, begin, end, nearest, source,
                                           output);
}

}  // namespace calvin::remap
#endif
