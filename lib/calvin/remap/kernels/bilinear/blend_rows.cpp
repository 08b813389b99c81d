// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Blends rows of runs: bilinear and nearest-neighbour resampling, many samples at a time, for every
// instruction set.
//
// A vector is as many 128-bit lanes as the machine has, and a lane eight results: samples that lie
// next to each other in the output. They come from source samples next to each other, so that 16
// bytes of each source row hold all of them. One byte shuffle fetches the pairs of neighbours,
// one multiplication of pairs blends them across, and two such rows are blended down. The results
// of a run fill one lane, or two or four of them where pixels have several components.
// Everything that differs between memory layouts is in
// remap/kernels/bilinear/memory_layout-inl.hpp; pixels of three and four bytes are in
// remap/kernels/bilinear/per_pixel-inl.hpp unless all bytes of a vector can be permuted.

// Compiles for AVX3_DL, too: Ice Lake and Zen 4 permute all bytes of a vector.
#define HWY_WANT_AVX3_DL 1

#include "calvin/core/vector_targets.hpp"
#include "calvin/remap/kernels/bilinear/bilinear_kernel.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/kernels/bilinear/blend_rows.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/kernels/bilinear/memory_layout-inl.hpp"
#include "calvin/remap/kernels/bilinear/per_pixel-inl.hpp"
#include "calvin/remap/kernels/bilinear/source_coords-inl.hpp"
#include "calvin/remap/kernels/bilinear/taps-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every run is slow.

BlendRuns blender_of(PixelLayout /*layout*/, int /*run*/, bool /*nearest*/, int /*planes*/) {
  return [](const RowTask& /*task*/, int /*begin*/, int /*end*/, const PlaneRows& /*planes*/) {};
}

#else

// The samples of a block of runs, located before the first of them is blended: a processor cannot
// look as far ahead as it takes to locate and blend one sample, so that doing both in turn leaves
// it idle.
struct BlockSamples {
  alignas(64) std::int16_t bytes[kBlockSamples];   // as bytes_of()
  alignas(64) std::int16_t across[kBlockSamples];  // as across_of()
  alignas(64) std::int16_t down[kBlockSamples];    // as RunRow::middle
};

// The source coordinates of a vector of samples, which begins with the run `run`.
template <class P, bool kNearest, bool kSteady>
HWY_INLINE BothAxes<P> segment_coords(const RowTask& task, int run,
                                      hn::Vec<CoordNumbers<P>> band_fraction) {
  BothAxes<P> at = coords_of<P, kSteady>(task.row, task.band, run, band_fraction);
  if constexpr (kNearest) at.x = rounded_coord(CoordNumbers<P>(), at.x);
  return at;
}

template <class L, class P>
HWY_INLINE void store_coords(const BothAxes<P>& at, int to, BlockSamples& samples) {
  const CoordNumbers<P> d;
  hn::Store(bytes_of<P, kIndexStep<L>>(at.x), d, samples.bytes + to);
  hn::Store(across_of<P>(at.x), d, samples.across + to);
  hn::Store(at.y, d, samples.down + to);
}

template <class L, bool kNearest, class P = VectorLayoutOf<L>>
HWY_INLINE void locate_block(const RowTask& task, int begin, int end,
                             hn::Vec<CoordNumbers<P>> band_fraction, BlockSamples& samples) {
  constexpr int kRuns = P::kSamples / P::kRun;
  int to = 0;
  for (int j = begin; j < end; j += kRuns, to += P::kSamples) {
    if (HWY_LIKELY(has(task.row.marks[j], RunMark::kSteady))) {
      store_coords<L, P>(segment_coords<P, kNearest, true>(task, j, band_fraction), to, samples);
    } else {
      store_coords<L, P>(segment_coords<P, kNearest, false>(task, j, band_fraction), to, samples);
    }
  }
}

// The taps of the vector of results whose first sample is `first`. `of_results` is as
// Results::neighbours.
template <class L>
HWY_INLINE Taps taps_at(const BlockSamples& samples, int first, const std::uint16_t* of_results) {
  const Words words;
  const auto neighbours = hn::BitCast(words, numbers_of<L>(samples.bytes + first));
  return {hn::BitCast(Bytes(), neighbours + hn::Load(words, of_results)),
          numbers_of<L>(samples.across + first), numbers_of<L>(samples.down + first)};
}

// How many rows before its use a row of the source is prefetched: the hardware does not foresee a
// walk along a curve. The cache holds fewer rows where pixels have more bytes. To be tuned
// with `tests/bench/run.sh undistort`.
template <class L>
constexpr int kAhead = L::kStep* L::kSampleBytes < 4 ? 12 : 8;

// The planes that a row is blended from and to; `ahead` is where `sources` are prefetched.
template <int kPlanes>
struct Planes {
  std::array<const std::uint8_t*, kPlanes> sources;
  std::array<const std::uint8_t*, kPlanes> ahead;
  std::array<std::uint8_t*, kPlanes> outputs;
  std::int32_t stride;
};

// ---- Runs of a single component: their samples stay in registers.

// Blends a vector of the group of runs whose first run is `j`: the whole group, or every other run
// of it, from the first run (kSecond = 0) or from the second one (1) on.
template <class L, bool kSteady, bool kThree, bool kNearest, int kSecond, int kPlanes>
HWY_INLINE std::array<typename BlenderOf<L>::Sums, kPlanes> blend_vector_of(
    const RowTask& task, int j, Numbers band_fraction, const Planes<kPlanes>& planes,
    const BlenderOf<L>& blender) {
  using P = VectorLayoutOf<L>;
  const Words words;
  BothAxes<P> at = coords_of<P, kSteady>(task.row, task.band, j + kSecond * kLanes, band_fraction);
  if constexpr (kNearest) at.x = rounded_coord(Signed(), at.x);
  auto neighbours = hn::BitCast(words, bytes_of<P, kIndexStep<L>>(at.x));
  if constexpr (kByWindows<L>) {
    neighbours = neighbours + in_register(hn::Load(words, kResults<L>.neighbours));
  }
  const Taps taps = {hn::BitCast(Bytes(), neighbours), across_of<P>(at.x), at.y};
  const std::int32_t* offsets = task.row.offset + j;
  std::array<typename BlenderOf<L>::Sums, kPlanes> results;
  HWY_UNROLL(kMaxPlanes)
  for (int p = 0; p < kPlanes; ++p) {
    fetch_ahead(planes.ahead[p] + offsets[kSecond * kLanes]);
    results[p] = blend_rows<L, kThree, kNearest>(task.row, j, offsets + kSecond, taps,
                                                 planes.sources[p], planes.stride, blender);
  }
  return results;
}

// Blends the group whose first run is `j`: it is two vectors, whose results are packed lane by
// lane, or one.
template <class L, bool kSteady, bool kThree, bool kNearest, int kPlanes>
HWY_INLINE void blend_group(const RowTask& task, int j, Numbers band_fraction,
                            const Planes<kPlanes>& planes, const BlenderOf<L>& blender) {
  const auto first =
      blend_vector_of<L, kSteady, kThree, kNearest, 0>(task, j, band_fraction, planes, blender);
  if constexpr (VectorLayoutOf<L>::kPaired) {
    const auto second =
        blend_vector_of<L, kSteady, kThree, kNearest, 1>(task, j, band_fraction, planes, blender);
    HWY_UNROLL(kMaxPlanes)
    for (int p = 0; p < kPlanes; ++p) {
      hn::StoreU(blender.pack(first[p], second[p]), Bytes(), planes.outputs[p]);
    }
  } else {
    HWY_UNROLL(kMaxPlanes)
    for (int p = 0; p < kPlanes; ++p) {
      hwy::Prefetch(planes.outputs[p] + kWriteAhead);
      store_results<L>(blender.rounded(first[p]), planes.outputs[p]);
    }
  }
}

// Blends any group but a steady one of three rows.
template <class L, bool kNearest, int kPlanes>
HWY_INLINE void blend_other(const RowTask& task, int j, Numbers band_fraction,
                            const Planes<kPlanes>& planes, const BlenderOf<L>& blender) {
  const RunMarks marks = task.row.marks[j];
  if (has(marks, RunMark::kSlowGroup)) return;
  if (has(marks, RunMark::kSteady)) {
    blend_group<L, true, false, kNearest>(task, j, band_fraction, planes, blender);
  } else if (source_rows(marks) == 3) {
    blend_group<L, false, true, kNearest>(task, j, band_fraction, planes, blender);
  } else {
    blend_group<L, false, false, kNearest>(task, j, band_fraction, planes, blender);
  }
}

template <class L, bool kNearest, int kPlanes>
HWY_INLINE void blend_single(const RowTask& task, int begin, int end, Planes<kPlanes> planes) {
  constexpr int kGroup = VectorLayoutOf<L>::kGroup;
  const auto blender = make_blender<L>(task.format);
  const auto band_fraction =
      in_register(hn::Set(Signed(), static_cast<std::int16_t>(task.band_fraction * 0x7FFF)));
  const RunMarks* marks = task.row.marks;
  const auto next = [&](int j) HWY_ATTR {
    for (auto& output : planes.outputs) output += kGroup * L::kRunPixels * L::kSampleBytes;
    return j + kGroup;
  };
  for (int j = begin; j < end;) {
    // A loop of its own for the most frequent kind, so that its constants stay in registers.
    for (; HWY_LIKELY(j < end && marks[j] == kSteadyThree); j = next(j)) {
      blend_group<L, true, true, kNearest>(task, j, band_fraction, planes, blender);
    }
    for (; j < end && marks[j] != kSteadyThree; j = next(j)) {
      blend_other<L, kNearest>(task, j, band_fraction, planes, blender);
    }
  }
}

// ---- Runs of several components or of 16-bit samples, block after block.

// Blends the `v`th vector of the group of runs whose first run is `j`, in the plane `p`.
template <class L, bool kThree, bool kNearest, int kPlanes>
HWY_INLINE auto vector_of(const RunRow& row, int j, int v, const Taps& taps,
                          const Planes<kPlanes>& planes, int p, const BlenderOf<L>& blender) {
  const std::int32_t* offsets = kByLanes<L> ? row.part_offset + j * L::kSpan + v * kLanes
                                            : row.offset + j + v * kLanes / L::kSpan;
  fetch_ahead(planes.ahead[p] + offsets[0]);
  return blend_rows<L, kThree, kNearest>(row, j, offsets, taps, planes.sources[p], planes.stride,
                                         blender);
}

template <class L, bool kThree, bool kNearest, int kPlanes>
HWY_INLINE void blend_vector(const RunRow& row, int j, int v, const Taps& taps,
                             const Planes<kPlanes>& planes, const BlenderOf<L>& blender) {
  for (int p = 0; p < kPlanes; ++p) {
    if constexpr (L::kSampleBytes > 1) hwy::Prefetch(planes.outputs[p] + v * L::kOut + kWriteAhead);
    const auto sums = vector_of<L, kThree, kNearest>(row, j, v, taps, planes, p, blender);
    store_results<L>(blender.rounded(sums), planes.outputs[p] + v * L::kOut);
  }
}

// Blends the `v`th vector and the next one.
template <class L, bool kThree, bool kNearest, int kPlanes>
HWY_INLINE void blend_pair(const RunRow& row, int j, int v, const Taps& first, const Taps& second,
                           const Planes<kPlanes>& planes, const BlenderOf<L>& blender) {
  for (int p = 0; p < kPlanes; ++p) {
    hwy::Prefetch(planes.outputs[p] + v * L::kOut + kWriteAhead);
    const auto a = vector_of<L, kThree, kNearest>(row, j, v, first, planes, p, blender);
    const auto b = vector_of<L, kThree, kNearest>(row, j, v + 1, second, planes, p, blender);
    store_pair<L>(blender.pack(a, b), planes.outputs[p] + v * L::kOut);
  }
}

template <class L, bool kNearest, int kPlanes>
HWY_INLINE void blend_blocks(const RowTask& task, int begin, int end, Planes<kPlanes> planes) {
  using P = VectorLayoutOf<L>;
  const auto blender = make_blender<L>(task.format);
  const auto band_fraction =
      hn::Set(CoordNumbers<P>(), static_cast<std::int16_t>(task.band_fraction * 0x7FFF));
  const std::uint16_t* of_results =
      task.format.swapped ? kResults<L>.swapped : kResults<L>.neighbours;
  BlockSamples samples;
  const auto blend_runs_of = [&](auto three, int j, int first) HWY_ATTR {
    constexpr bool kThree = decltype(three)::value;
    const auto taps = [&](int v) HWY_ATTR {
      return taps_at<L>(samples, first + v * L::kPixels * kLanes, of_results);
    };
    if constexpr (kByPairs<L>) {
      for (int v = 0; v < L::kSpan; v += 2) {
        blend_pair<L, kThree, kNearest>(task.row, j, v, taps(v), taps(v + 1), planes, blender);
      }
    } else {
      for (int v = 0; v < L::kSpan; ++v) {
        blend_vector<L, kThree, kNearest>(task.row, j, v, taps(v), planes, blender);
      }
    }
  };
  for (int block = begin; block < end; block += kBlockRuns) {
    const int last = std::min(block + kBlockRuns, end);
    locate_block<L, kNearest>(task, block, last, band_fraction, samples);
    int first = 0;
    for (int j = block; j < last; j += kLanes, first += kLanes * L::kRunPixels) {
      const RunMarks marks = task.row.marks[j];
      const bool left_out = has(marks, RunMark::kSlowGroup);
      if (!left_out && HWY_LIKELY(source_rows(marks) == 3)) {
        blend_runs_of(std::true_type(), j, first);
      } else if (!left_out) {
        blend_runs_of(std::false_type(), j, first);
      }
      for (auto& output : planes.outputs) output += L::kSpan * L::kOut;
    }
  }
}

// A BlendRuns for `kPlanes` planes at once.
template <class L, bool kNearest, int kPlanes>
void blend(const RowTask& shared, int begin, int end, const PlaneRows& rows) {
  // A copy: for all that the compiler knows, each store of pixels might change `shared`.
  const RowTask task = shared;
  Planes<kPlanes> planes;
  planes.stride = task.stride;
  for (int p = 0; p < kPlanes; ++p) {
    planes.sources[p] = rows.source[p];
    planes.ahead[p] = rows.source[p] + static_cast<std::ptrdiff_t>(kAhead<L>) * task.stride + 16;
    planes.outputs[p] = rows.output[p];
  }
  if constexpr (L::kStep == 1) {
    blend_single<L, kNearest>(task, begin, end, planes);
  } else {
    blend_blocks<L, kNearest>(task, begin, end, planes);
  }
}

// Blends planes one after the other. Only planes of a single component come by twos (the chroma of
// I420), and only for them it pays to locate the samples once for both.
template <class L, bool kNearest>
void blend_each(const RowTask& task, int begin, int end, const PlaneRows& planes) {
  for (int p = 0; p < planes.planes; ++p) {
    blend<L, kNearest, 1>(task, begin, end, {{planes.source[p]}, {planes.output[p]}, 1});
  }
}

// Chooses the instance of blend() or blend_per_pixel() for a layout.
struct Chooser {
  // For runs of eight samples, or of one lane.
  template <int kComponents, int kSpacing>
  [[nodiscard]] BlendRuns length() const {
    using Long = MemoryLayout<kComponents, kSpacing, 8>;
    using Short = MemoryLayout<kComponents, kSpacing, Long::kPixels>;
    if constexpr (std::is_same_v<Long, Short>) {
      return layout<Long>();
    } else {
      return run == 8 ? layout<Long>() : layout<Short>();
    }
  }

  // For pixels of 16-bit samples that have `kPixelBytes` bytes.
  template <int kPixelBytes>
  [[nodiscard]] BlendRuns words() const {
    return layout<MemoryLayout<kPixelBytes, 1, 8, true>>();
  }

  // For pixels of three or four components.
  template <int kComponents>
  [[nodiscard]] BlendRuns large() const {
    if constexpr (kMovesAllBytes) return length<kComponents, 1>();
    return run == 8 ? &blend_per_pixel<8, kComponents> : &blend_per_pixel<2, kComponents>;
  }

  template <class L>
  [[nodiscard]] BlendRuns layout() const {
    constexpr bool kSingle = L::kStep * L::kSampleBytes == (L::kOfWords ? 2 : 1);
    if (nearest) return &blend_each<L, true>;
    if constexpr (kSingle) {
      if (planes == 2) return &blend<L, false, 2>;
    }
    return &blend_each<L, false>;
  }

  int run;
  bool nearest;
  int planes;
};

BlendRuns blender_of(PixelLayout layout, int run, bool nearest, int planes) {
  const Chooser choose = {run, nearest, planes};
  switch (layout) {
    case PixelLayout::kOne:
      return choose.length<1, 1>();
    case PixelLayout::kTwo:
      return choose.length<2, 1>();
    case PixelLayout::kThree:
      return choose.large<3>();
    case PixelLayout::kFour:
      return choose.large<4>();
    case PixelLayout::kOneStrided:
      return choose.length<1, 2>();
    case PixelLayout::kTwoStrided:
      return choose.length<2, 2>();
    case PixelLayout::kOneWord:
      return choose.words<2>();
    case PixelLayout::kTwoWords:
      return choose.words<4>();
    default:
      return
          [](const RowTask& /*task*/, int /*begin*/, int /*end*/, const PlaneRows& /*planes*/) {};
  }
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(blender_of);

BlendRuns run_blender(PixelLayout layout, int run, bool nearest, int planes) noexcept {
  return HWY_DYNAMIC_DISPATCH(blender_of)(layout, run, nearest, planes);
}

}  // namespace calvin::remap
#endif
