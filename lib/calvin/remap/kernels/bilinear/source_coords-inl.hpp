// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The source coordinates of each sample of a run, and the bytes and weights that follow from them:
// vectors of 16-bit numbers, one per sample. Compiled once per target of Highway: include it after
// hwy/foreach_target.h.
#if defined(CALVIN_REMAP_SOURCE_COORDS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_SOURCE_COORDS_INL_HPP
#undef CALVIN_REMAP_SOURCE_COORDS_INL_HPP
#else
#define CALVIN_REMAP_SOURCE_COORDS_INL_HPP
#endif

#include "calvin/remap/kernels/bilinear/band.hpp"
#include "calvin/remap/kernels/bilinear/vector_layout-inl.hpp"
#include "calvin/remap/kernels/common/blend_math-inl.hpp"
#include "calvin/remap/kernels/common/run_row.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Runs whose samples are located before the first of them is blended. To be tuned with
// `tests/bench/run.sh undistort`.
constexpr int kBlockRuns = 32;
// The samples of such a block, and eight more: samples are read eight at a time.
constexpr int kBlockSamples = 8 * kBlockRuns + 8;

// How many bytes before it is written the output is prefetched: a cache line must be loaded before
// a part of it can be written. To be tuned likewise.
constexpr int kWriteAhead = 1024;

template <class P>
using CoordWords = hn::FixedTag<std::uint16_t, P::kSamples>;
template <class P>
using AddressInts = hn::FixedTag<std::int32_t, P::kSamples / 2>;

// The source coordinates of the vector of samples that begins with the run `run`, counted as
// RunRow::middle. `band_fraction` is as in RowTask, 1.15; only steady runs need it.
template <class P, bool kSteady>
HWY_INLINE BothAxes<P> coords_of(const RunRow& row, const Band& band, int run,
                                 hn::Vec<CoordNumbers<P>> band_fraction) {
  const CoordNumbers<P> d;
  BothAxes<P> at = spread_records<P, P::kRun / P::kParts>(row.middle + run * P::kParts);
  if constexpr (kSteady) {
    const int sample = run * P::kRun;
    at.x = at.x + hn::Load(d, band.x_shape + sample) +
           hn::MulFixedPoint15(hn::Load(d, band.x_change + sample), band_fraction);
    at.y = at.y + hn::Load(d, band.y_shape + sample) +
           hn::MulFixedPoint15(hn::Load(d, band.y_change + sample), band_fraction);
  } else {
    const BothAxes<P> shape = shape_of<P>(row.slope + run, row.bend + run);
    at.x = at.x + shape.x;
    at.y = at.y + shape.y;
  }
  return at;
}

// Coordinates in 4.12, rounded to the nearest sample.
template <class D>
HWY_INLINE hn::Vec<D> rounded_coord(D d, hn::Vec<D> coord) {
  const hn::RebindToUnsigned<D> words;
  return hn::And(coord + hn::Set(d, 2048), hn::BitCast(d, hn::Set(words, 0xF000)));
}

// Twice the weight of the right one of two neighbours, less 1; 1.15.
template <class P>
HWY_INLINE hn::Vec<CoordNumbers<P>> across_of(hn::Vec<CoordNumbers<P>> x) {
  const CoordNumbers<P> d;
  const CoordWords<P> words;
  return hn::BitCast(
      d, hn::Xor(hn::ShiftLeft<4>(hn::BitCast(words, x)), in_register(hn::Set(words, 0x8000))));
}

// Which two bytes of the segment are blended, as a pair of byte indices in 16 bits: 0x0101 times
// the bytes before the left sample, plus 0x0100 times those of a step for the right one. A step s
// that is larger than 1 makes the left index too large by s - 1: the tables of
// remap/kernels/bilinear/memory_layout-inl.hpp and remap/kernels/bilinear/windows-inl.hpp take that
// away.
template <class P, int kStep = P::kStep>
HWY_INLINE hn::Vec<CoordNumbers<P>> bytes_of(hn::Vec<CoordNumbers<P>> x) {
  const CoordNumbers<P> d;
  const CoordWords<P> words;
  return hn::BitCast(d,
                     hn::MulHigh(hn::Or(hn::BitCast(words, x), in_register(hn::Set(words, 0x0FFF))),
                                 in_register(hn::Set(words, 0x1010 * kStep))));
}

// ---- Pixels with addresses of their own.

// Byte shuffles that give each sample the offset of its run, for the lower and the upper half of a
// vector whose columns and rows are interleaved.
struct Bases {
  alignas(64) std::uint8_t lower[64];
  alignas(64) std::uint8_t upper[64];
};
constexpr Bases make_bases(int run) {
  Bases b{};
  for (int i = 0; i < 64; ++i) {
    const int sample = i / 16 * 8 + i % 16 / 4;
    b.lower[i] = static_cast<std::uint8_t>((4 * (sample / run) + i % 4) % 16);
    b.upper[i] = static_cast<std::uint8_t>((4 * ((sample + 4) / run) + i % 4) % 16);
  }
  return b;
}
template <int kRun>
constexpr Bases kBases = make_bases(kRun);

// The bytes to a row and to a column of the source, as factors of one multiplication: the low 15
// bits of the stride and the step. `rest` are the other bits of the stride, 0 for nearly all
// frames.
struct Stride {
  Stride(std::int32_t stride, int step)
      : products(static_cast<std::int32_t>(stride & 0x7FFF) << 16 | step), rest(stride & ~0x7FFF) {}
  std::int32_t products;
  std::int32_t rest;
};

// Stores the addresses of the pixels of a vector: in bytes from their run's offset, or from the
// beginning of the plane where eight pixels are of several runs.
template <class P>
HWY_INLINE void store_addresses(const BothAxes<P>& at, const std::int32_t* run_offsets,
                                Stride stride, std::int32_t* to) {
  const CoordWords<P> words;
  const CoordNumbers<P> numbers;
  const AddressInts<P> ints;
  const hn::Repartition<std::uint8_t, AddressInts<P>> bytes;
  const auto columns = hn::ShiftRight<12>(hn::BitCast(words, at.x));
  const auto rows = hn::ShiftRight<12>(hn::BitCast(words, at.y));
  const auto factors = hn::BitCast(numbers, hn::Set(ints, stride.products));
  const auto address = [&](auto pairs, [[maybe_unused]] const std::uint8_t* base) HWY_ATTR {
    auto sum = add_word_products(numbers, hn::BitCast(numbers, pairs), factors);
    if constexpr (P::kRun < 8) {
      const auto* offsets = reinterpret_cast<const std::uint8_t*>(run_offsets);
      sum = sum + hn::BitCast(ints, hn::TableLookupBytes(hn::LoadDup128(bytes, offsets),
                                                         hn::Load(bytes, base)));
    }
    if (HWY_UNLIKELY(stride.rest != 0)) {
      sum = sum + hn::ShiftRight<16>(hn::BitCast(ints, pairs)) * hn::Set(ints, stride.rest);
    }
    return sum;
  };
  const auto lower = address(hn::InterleaveLower(columns, rows), kBases<P::kRun>.lower);
  const auto upper = address(hn::InterleaveUpper(words, columns, rows), kBases<P::kRun>.upper);
  // The two halves of a vector of 256 bits are interleaved each by itself.
  if constexpr (P::kSamples == 16 && !P::kSplit) {
    const hn::Half<AddressInts<P>> half;
    hn::Store(hn::LowerHalf(lower), half, to);
    hn::Store(hn::LowerHalf(upper), half, to + 4);
    hn::Store(hn::UpperHalf(half, lower), half, to + 8);
    hn::Store(hn::UpperHalf(half, upper), half, to + 12);
  } else {
    hn::Store(lower, ints, to);
    hn::Store(upper, ints, to + P::kSamples / 2);
  }
}

// The weight of the lower one of two rows, 1.15.
template <class P>
HWY_INLINE hn::Vec<CoordNumbers<P>> down_of(hn::Vec<CoordNumbers<P>> y) {
  const CoordNumbers<P> d;
  const CoordWords<P> words;
  return hn::BitCast(
      d, hn::And(hn::ShiftLeft<3>(hn::BitCast(words, y)), in_register(hn::Set(words, 0x7FFF))));
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
