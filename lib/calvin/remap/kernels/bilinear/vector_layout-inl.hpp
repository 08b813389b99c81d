// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How runs become vectors of samples, by memory layout. Compiled once per target of Highway:
// include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_VECTOR_LAYOUT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_VECTOR_LAYOUT_INL_HPP
#undef CALVIN_REMAP_VECTOR_LAYOUT_INL_HPP
#else
#define CALVIN_REMAP_VECTOR_LAYOUT_INL_HPP
#endif

#include <algorithm>
#include <utility>

#include "calvin/remap/kernels/common/pixel_layout.hpp"
#include "calvin/remap/kernels/common/vectors-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Runs of `kRunSamples` samples that are cut into `kRunParts` parts with segments of their own,
// and whose samples are `kBytesPerStep` bytes apart. With `kOwnAddresses` each pixel has an address
// of its own.
template <int kRunSamples, int kRunParts, int kBytesPerStep, bool kOwnAddresses = false>
struct VectorLayout {
  static constexpr int kRun = kRunSamples;
  static constexpr int kParts = kRunParts;
  static constexpr int kStep = kBytesPerStep;
  static constexpr bool kPerPixel = kOwnAddresses;
  // The results of two vectors are packed lane by lane: the first vector has every other run.
  static constexpr bool kPaired = kStep == 1;
  static constexpr int kGroup = kPaired ? 2 * kLanes : kPerPixel && kRun < 8 ? 4 : kLanes;
  // Samples in a vector of 16-bit numbers: those of four runs, or parts of runs, at most, since a
  // lane has four records.
  static constexpr int kSamples =
      std::min({static_cast<int>(kBytes) / 2, 4 * kRun / kParts, kPerPixel ? 16 : 32});
  // Each of a vector's two lanes holds four samples of one run and four of another one:
  // interleaving works by lanes, and so gives the samples in order.
  static constexpr bool kSplit = kPerPixel && kStep == 4 && kRun == 8 && kSamples == 16;
};

// Calls f with the VectorLayout of a layout; not at all where there is no kernel.
template <class F>
HWY_INLINE void with_vector_layout(PixelLayout layout, int run, F f) {
  constexpr int kParts = kMovesAllBytes ? 1 : 2;
  constexpr int kPartsOfPairs = kMovesAllBytes ? 1 : 4;  // of 16-bit samples
  constexpr bool kPerPixel = !kMovesAllBytes;
  const bool whole = run == 8;
  switch (layout) {
    case PixelLayout::kOne:
      return f(VectorLayout<8, 1, 1>());
    case PixelLayout::kOneStrided:
      return f(VectorLayout<8, 1, 2>());
    case PixelLayout::kTwo:
      return whole ? f(VectorLayout<8, kParts, 2>()) : f(VectorLayout<4, 1, 2>());
    case PixelLayout::kTwoStrided:
      return whole ? f(VectorLayout<8, kParts, 4>()) : f(VectorLayout<4, 1, 4>());
    case PixelLayout::kOneWord:
      if (whole) f(VectorLayout<8, kParts, 2>());
      return;
    case PixelLayout::kTwoWords:
      if (whole) f(VectorLayout<8, kPartsOfPairs, 4>());
      return;
    case PixelLayout::kThree:
      return whole ? f(VectorLayout<8, 1, 3, kPerPixel>()) : f(VectorLayout<2, 1, 3, kPerPixel>());
    case PixelLayout::kFour:
      return whole ? f(VectorLayout<8, 1, 4, kPerPixel>()) : f(VectorLayout<2, 1, 4, kPerPixel>());
    default:
      return;
  }
}

// The order in which the kernel takes the records of a vector of runs, by their index.
struct RecordOrder {
  alignas(64) std::int32_t from[16];
};
constexpr RecordOrder make_paired_order() {
  RecordOrder order{};
  for (int i = 0; i < 16; ++i) {
    const int of_group = i % (2 * kLanes);
    order.from[i] = i - of_group + 2 * (of_group % kLanes) + of_group / kLanes;
  }
  return order;
}
constexpr RecordOrder kPairedOrder = make_paired_order();

// Calls f with the number of each part, as a constant.
template <class P, class F>
HWY_INLINE void for_parts(F f) {
  const auto call = [&]<int... kPart>(std::integer_sequence<int, kPart...> /*parts*/) HWY_ATTR {
    (f(std::integral_constant<int, kPart>()), ...);
  };
  call(std::make_integer_sequence<int, P::kParts>());
}

template <class P>
HWY_INLINE hn::Vec<Ints> in_order(hn::Vec<Ints> records) {
  if constexpr (!P::kPaired || kLanes == 1) {
    return records;
  } else {
    return hn::TableLookupLanes(records, hn::SetTableIndices(Ints(), kPairedOrder.from));
  }
}

// Stores a record of each part of a vector of runs: all parts of a run, then those of the next one.
template <class P, class F>
HWY_INLINE void store_parts(F part, std::int32_t* to) {
  const Ints d;
  if constexpr (P::kParts == 1) {
    hn::Store(part(0), d, to);
  } else if constexpr (P::kParts == 2) {
    hn::StoreInterleaved2(part(0), part(1), d, to);
  } else {
    static_assert(P::kParts == 4);
    hn::StoreInterleaved4(part(0), part(1), part(2), part(3), d, to);
  }
}

// Byte shuffles that give each 16-bit sample its half of the record of its run, or of its part of a
// run.
struct Halves {
  alignas(64) std::uint8_t low[64];
  alignas(64) std::uint8_t high[64];
};
constexpr Halves make_halves(int samples_per_record, bool split) {
  Halves h{};
  for (int i = 0; i < 64; ++i) {
    const int sample = split ? i % 16 : i / 2;
    const int record = 4 * (sample / samples_per_record) % 16;
    h.low[i] = static_cast<std::uint8_t>(record + i % 2);
    h.high[i] = static_cast<std::uint8_t>(record + i % 2 + 2);
  }
  return h;
}
template <int kSamplesPerRecord, bool kSplit>
constexpr Halves kHalves = make_halves(kSamplesPerRecord, kSplit);

// The factors of slope and bend for each sample of a run: t and t^2, of the distance t from the
// middle.
struct Arc {
  alignas(64) std::int16_t along[32];   // slope 2.14 -> distance 4.12, through MulFixedPoint15
  alignas(64) std::int16_t square[32];  // bend -> distance 4.12, likewise
};
constexpr Arc make_arc(int run, bool split) {
  Arc arc{};
  for (int i = 0; i < 32; ++i) {
    const int sample = split ? i / 8 * 4 + i % 4 : i;
    const int halves = 2 * (sample % run) - reach(run);
    arc.along[i] = static_cast<std::int16_t>(halves * 4096);
    arc.square[i] = static_cast<std::int16_t>(halves * halves * 32767 / (reach(run) * reach(run)));
  }
  return arc;
}
template <int kRun, bool kSplit>
constexpr Arc kArc = make_arc(kRun, kSplit);

template <class P>
using CoordNumbers = hn::FixedTag<std::int16_t, P::kSamples>;

// A number of each axis for a vector of samples.
template <class P>
struct BothAxes {
  hn::Vec<CoordNumbers<P>> x;
  hn::Vec<CoordNumbers<P>> y;
};

// Gives each sample the two numbers in the record of its run, or part of a run: four records.
template <class P, int kSamplesPerRecord>
HWY_INLINE BothAxes<P> spread_records(const std::int32_t* records) {
  const CoordNumbers<P> numbers;
  const hn::Repartition<std::uint8_t, CoordNumbers<P>> bytes;
  constexpr const Halves& kWhich = kHalves<kSamplesPerRecord, P::kSplit>;
  const auto all = hn::LoadDup128(bytes, reinterpret_cast<const std::uint8_t*>(records));
  return {hn::BitCast(numbers, hn::TableLookupBytes(all, hn::Load(bytes, kWhich.low))),
          hn::BitCast(numbers, hn::TableLookupBytes(all, hn::Load(bytes, kWhich.high)))};
}

// The distances of samples from the middles of their runs, 4.12.
template <class P>
HWY_INLINE BothAxes<P> shape_of(const std::int32_t* slopes, const std::int32_t* bends) {
  const CoordNumbers<P> numbers;
  constexpr const Arc& kAll = kArc<P::kRun, P::kSplit>;
  const auto along = hn::Load(numbers, kAll.along);
  const BothAxes<P> slope = spread_records<P, P::kRun>(slopes);
  BothAxes<P> shape = {hn::MulFixedPoint15(slope.x, along), hn::MulFixedPoint15(slope.y, along)};
  if constexpr (P::kRun > 2) {
    const auto square = hn::Load(numbers, kAll.square);
    const BothAxes<P> bend = spread_records<P, P::kRun>(bends);
    shape.x = shape.x + hn::MulFixedPoint15(bend.x, square);
    shape.y = shape.y + hn::MulFixedPoint15(bend.y, square);
  }
  return shape;
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
