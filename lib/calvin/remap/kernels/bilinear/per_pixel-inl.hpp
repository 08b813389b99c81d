// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of pixels of three or four bytes, each of which has an address of its own: 8
// bytes hold the pixel and its right neighbour. Where windows hold a run, it goes the quicker way
// of remap/kernels/bilinear/windows-inl.hpp. Compiled once per target of Highway: include it after
// hwy/foreach_target.h.
#if defined(CALVIN_REMAP_PER_PIXEL_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_PER_PIXEL_INL_HPP
#undef CALVIN_REMAP_PER_PIXEL_INL_HPP
#else
#define CALVIN_REMAP_PER_PIXEL_INL_HPP
#endif

#include <algorithm>

#include "calvin/remap/kernels/bilinear/windows-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// Loads 16 bytes for each lane; a lane has four addresses, of which the first one counts.
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

// Blends two pixels of each lane across: the first two of its four addresses.
template <int kComponents>
HWY_INLINE hn::Vec<PerPixelNumbers> blend_across(const std::uint8_t* source,
                                                 const std::int32_t* addresses,
                                                 hn::Vec<PerPixelNumbers> across,
                                                 const Blender<PerPixelBytes>& blender) {
  const PerPixelBytes bytes;
  const hn::Repartition<std::uint64_t, PerPixelBytes> halves;
  const auto both =
      hn::InterleaveLower(halves, hn::BitCast(halves, load_lanes(bytes, source, addresses)),
                          hn::BitCast(halves, load_lanes(bytes, source, addresses + 1)));
  const auto which = hn::Load(bytes, kPerPixelTables<kComponents>.neighbours);
  return blender.across(hn::TableLookupBytes(hn::BitCast(bytes, both), which), across);
}

// Blends the `k`th two pixels of each lane, in the `kPart`th eight pixels of a vector.
template <class P, int kPart>
HWY_INLINE hn::Vec<PerPixelNumbers> blend_two(const std::uint8_t* source, std::ptrdiff_t stride,
                                              const PixelVector<P>& pixels, int k,
                                              const Blender<PerPixelBytes>& blender) {
  constexpr int kFirst = 8 * kPart;
  const std::int32_t* addresses = pixels.address + kFirst + 2 * k;
  const auto across = weights_of<P, kPart>(pixels.across + kFirst, k);
  const auto upper = blend_across<P::kStep>(source, addresses, across, blender);
  const auto lower = blend_across<P::kStep>(source + stride, addresses, across, blender);
  return blender.rounded(
      blender.between(upper, lower, weights_of<P, kPart>(pixels.down + kFirst, k)));
}

// Stores the pixels of a vector: four per lane.
template <int kComponents, class D>
HWY_INLINE void store_per_pixel(D d, hn::Vec<D> pixels, std::uint8_t* out) {
  if constexpr (kComponents == 4) {
    hn::StoreU(pixels, d, out);
  } else {
    const auto front =
        hn::TableLookupBytes(pixels, hn::Load(d, kPerPixelTables<kComponents>.front));
    const hn::FixedTag<std::uint8_t, 16> lane;
    if constexpr (hn::MaxLanes(D()) == 16) {
      hn::StoreU(front, lane, out);
    } else {
      // The four bytes behind a lane's twelve are written over by the next store.
      hn::StoreU(hn::LowerHalf(front), lane, out);
      hn::StoreU(hn::UpperHalf(lane, front), lane, out + 12);
    }
  }
}

// Blends the `kPart`th eight pixels of a vector.
template <class P, int kPart>
HWY_INLINE void blend_eight(const PerPixelRow& row, std::int32_t offset,
                            const PixelVector<P>& pixels, std::uint8_t* out) {
  const PerPixelBytes bytes;
  const std::uint8_t* source = row.source + offset;
  fetch_ahead(source + pixels.address[8 * kPart] + kPerPixelAhead * row.stride + 32);
  for (int i = 0; i < 2 / kPerPixelLanes; ++i) {
    const auto a = blend_two<P, kPart>(source, row.stride, pixels, 2 * i, row.blender);
    const auto b = blend_two<P, kPart>(source, row.stride, pixels, 2 * i + 1, row.blender);
    store_per_pixel<P::kStep>(bytes, pack_lanes(bytes, a, b), out + 4 * i * P::kStep);
  }
}

// Blends a vector of pixels.
template <class P>
HWY_INLINE void blend_pixels(const PerPixelRow& row, const std::int32_t* offsets,
                             const PixelVector<P>& pixels, std::uint8_t* out) {
  const auto offset = [&](int run) HWY_ATTR { return P::kRun < 8 ? 0 : offsets[run]; };
  blend_eight<P, 0>(row, offset(0), pixels, out);
  if constexpr (P::kSamples == 16) {
    blend_eight<P, 1>(row, offset(1), pixels, out + 8 * P::kStep);
  }
}

// Locates a vector of pixels that have addresses of their own.
template <class P>
HWY_INLINE void store_pixels(BothAxes<P> at, const std::int32_t* offsets, Stride stride,
                             bool nearest, PixelVector<P>& pixels) {
  const CoordNumbers<P> d;
  auto down = down_of<P>(at.y);
  if (nearest) {
    at.x = rounded_coord(d, at.x);
    // y is not rounded as x is: the row behind the nearest one may be missing. One of the two rows
    // gets all the weight instead.
    down = hn::IfThenElseZero(hn::Gt(down, hn::Set(d, 0x3FFF)), hn::Set(d, 0x7FFF));
  }
  store_addresses<P>(at, offsets, stride, pixels.address);
  hn::Store(across_of<P>(at.x), d, pixels.across);
  hn::Store(down, d, pixels.down);
}

// Locates the pixels of the runs from `begin` to before `end`.
template <class P>
HWY_INLINE void locate_block(const RowTask& task, int begin, int end,
                             hn::Vec<CoordNumbers<P>> band_fraction, Stride stride,
                             PixelVector<P>* pixels) {
  for (int j = begin; j < end; j += P::kSamples / P::kRun, ++pixels) {
    const RunMarks marks = task.row.marks[j];
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
    if constexpr (kHasWindows<P>) {
      if (HWY_LIKELY(by_windows<P>(task, marks))) {
        locate_window<P>(coords_of<P, true>(task.row, task.band, j, band_fraction), *pixels);
        continue;
      }
    }
#endif
    const BothAxes<P> at = has(marks, RunMark::kSteady)
                               ? coords_of<P, true>(task.row, task.band, j, band_fraction)
                               : coords_of<P, false>(task.row, task.band, j, band_fraction);
    store_pixels<P>(at, task.row.offset + j, stride, task.nearest, *pixels);
  }
}

// Blends the runs from `begin` to before `end`, whose pixels are located.
template <class P>
HWY_INLINE void blend_block(const PerPixelRow& row, const RowTask& task, int begin, int end,
                            const PixelVector<P>* pixels, std::uint8_t* out) {
  const RunMarks* marks = task.row.marks + begin;
  const std::int32_t* offsets = task.row.offset + begin;
  constexpr int kRuns = P::kSamples / P::kRun;
  // A vector is a group of runs, or a part of one: its runs have the same marks.
  for (int j = 0; j < end - begin; j += kRuns, out += P::kSamples * P::kStep, ++pixels) {
    hwy::Prefetch(out + kWriteAhead);
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
    if constexpr (kHasWindows<P>) {
      if (HWY_LIKELY(by_windows<P>(task, marks[j]))) {
        blend_windows<P>(row, offsets + j, *pixels, out);
        continue;
      }
    }
#endif
    if (HWY_UNLIKELY(has(marks[j], RunMark::kSlowGroup))) continue;
    blend_pixels<P>(row, offsets + j, *pixels, out);
  }
}

// A BlendRuns, of runs of `kRun` samples.
template <int kRun, int kComponents>
void blend_per_pixel(const RowTask& shared, int begin, int end, const PlaneRows& planes) {
  using P = VectorLayout<kRun, 1, kComponents, true>;
  // A copy: for all that the compiler knows, each store of pixels might change `shared`.
  const RowTask task = shared;
  const Blender<PerPixelBytes> blender;
  const Stride stride(task.stride, kComponents);
  const auto band_fraction =
      hn::Set(CoordNumbers<P>(), static_cast<std::int16_t>(task.band_fraction * 0x7FFF));
  // The pixels of a block are located before the first of them is blended: a processor cannot look
  // as far ahead as it takes to locate and blend one.
  PixelVector<P> pixels[kBlockRuns * P::kRun / P::kSamples];
  for (int p = 0; p < planes.planes; ++p) {
    const PerPixelRow row = {planes.source[p], task.stride, blender};
    std::uint8_t* out = planes.output[p];
    for (int block = begin; block < end; block += kBlockRuns) {
      const int last = std::min(block + kBlockRuns, end);
      locate_block<P>(task, block, last, band_fraction, stride, pixels);
      blend_block<P>(row, task, block, last, pixels, out);
      out += kBlockRuns * kRun * kComponents;
    }
  }
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
