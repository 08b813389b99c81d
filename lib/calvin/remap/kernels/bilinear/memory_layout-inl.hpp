// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How samples lie in memory, and how vectors of them are loaded and stored. Compiled once per
// target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_MEMORY_LAYOUT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_MEMORY_LAYOUT_INL_HPP
#undef CALVIN_REMAP_MEMORY_LAYOUT_INL_HPP
#else
#define CALVIN_REMAP_MEMORY_LAYOUT_INL_HPP
#endif

#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

#include "calvin/remap/kernels/bilinear/vector_layout-inl.hpp"
#include "calvin/remap/kernels/bilinear/word_math-inl.hpp"
#include "calvin/remap/kernels/common/blend_math-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

// A memory layout, and how runs of `kRun` pixels of it fill lanes. With samples of 16 bits
// `kComponents` is the number of bytes per pixel.
template <int kComponents, int kSpacing, int kRun, bool kWords = false>
struct MemoryLayout {
  static constexpr bool kOfWords = kWords;
  static constexpr int kSampleBytes = kSpacing;                        // bytes per sample
  static constexpr int kStep = kComponents;                            // bytes per pixel, packed
  static constexpr int kWidth = std::bit_ceil(unsigned{kComponents});  // results per pixel
  static constexpr int kPixels = 8 / kWidth;                           // per lane
  static constexpr int kRunPixels = kRun;
  static constexpr int kSpan = kRun / kPixels;                            // lanes per run
  static constexpr int kWindow = 16 * kSpan * kSpacing;                   // bytes that hold a run
  static constexpr int kOut = kPixels * kComponents * kSpacing * kLanes;  // bytes per vector
  // As VectorLayout::kPaired: the lanes of a vector are of every other run.
  static constexpr int kEvery = kComponents * kSpacing == 1 ? 2 : 1;
};

// Whether the samples of a run are loaded at once, as one window: where any byte of a vector can be
// permuted to anywhere.
template <class L>
constexpr bool kByWindows = kMovesAllBytes&& L::kWindow > 16;

// Whether each lane has a segment of its own.
template <class L>
constexpr bool kByLanes = L::kSpan > 1 && !kMovesAllBytes;

// Bytes from a pixel to the next as byte indices count them: bytes between samples are left out
// when segments are loaded, but not in windows.
template <class L>
constexpr int kIndexStep = L::kStep*(kByWindows<L> ? L::kSampleBytes : 1);

// Whether vectors of results are stored two at a time.
template <class L>
constexpr bool kByPairs = L::kSpan > 1 && L::kSampleBytes == 1;

template <class L>
using BlenderOf = std::conditional_t<L::kOfWords, WordBlender, Blender<Bytes>>;
template <class L>
HWY_INLINE BlenderOf<L> make_blender([[maybe_unused]] WordFormat format) {
  if constexpr (L::kOfWords) {
    return WordBlender(format);
  } else {
    return Blender<Bytes>();
  }
}

template <class L>
using VectorLayoutOf =
    VectorLayout<L::kRunPixels, kByLanes<L> ? L::kSpan : 1, L::kStep * L::kSampleBytes>;

// By result of a vector: where the numbers of its sample are, and what is added to the byte indices
// of bytes_of().
struct Results {
  alignas(64) std::uint16_t numbers[32];     // the index of its pixel
  alignas(64) std::uint8_t samples[64];      // the same as a byte shuffle within 128 bits
  alignas(64) std::uint16_t neighbours[32];  // byte indices of the sample and its right neighbour
  alignas(64) std::uint16_t swapped[32];     // likewise, where the other byte of words comes first
};
template <class L>
constexpr Results make_results() {
  Results r{};
  constexpr int kSampleBytes = kIndexStep<L> / L::kStep;
  // What bytes_of() gives for the first column.
  constexpr int kFirst = (0x0FFF * 0x1010 * kIndexStep<L>) >> 16;
  for (int i = 0; i < 32; ++i) {
    const int pixel = i / 8 * L::kPixels + i % 8 / L::kWidth;
    const int of_pixel = i % L::kWidth;
    const int component = of_pixel < L::kStep ? of_pixel : 0;
    // With words two results are one sum: the pair of bytes of a sample, then that of its
    // neighbour.
    const int word = of_pixel / 2 * 2 + of_pixel % 2 * L::kStep;
    const int bytes =
        L::kOfWords ? word | (word + 1) << 8 : component | (component + L::kStep) << 8;
    const int window = kByWindows<L> ? i / 8 / L::kSpan * L::kWindow % 64 : 0;
    r.numbers[i] = static_cast<std::uint16_t>(pixel);
    r.samples[2 * i] = static_cast<std::uint8_t>(2 * pixel % 16);
    r.samples[2 * i + 1] = static_cast<std::uint8_t>(2 * pixel % 16 + 1);
    const int rest = window * 0x101 - kFirst;
    r.neighbours[i] = static_cast<std::uint16_t>(bytes * kSampleBytes + rest);
    r.swapped[i] = static_cast<std::uint16_t>((bytes >> 8 | (bytes & 0xFF) << 8) + rest);
  }
  return r;
}
template <class L>
constexpr Results kResults = make_results<L>();

// Gives each result of a vector the number of its sample.
template <class L>
HWY_INLINE Numbers numbers_of(const std::int16_t* samples) {
  const Bytes d;
  constexpr std::size_t kSamples = static_cast<std::size_t>(L::kPixels) * kLanes;
  if constexpr (L::kWidth == 1) return hn::Load(Signed(), samples);
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  if constexpr (kSamples == 16) {
    const auto all = _mm512_castsi256_si512(hn::Load(hn::Half<Signed>(), samples).raw);
    const auto which = hn::Load(Words(), kResults<L>.numbers);
    return Numbers{_mm512_permutexvar_epi16(which.raw, all)};
  }
#endif
  static_assert(L::kWidth == 1 || kSamples <= 8 || kBytes == 64);
  const auto all = hn::LoadDup128(d, reinterpret_cast<const std::uint8_t*>(samples));
  return hn::BitCast(Signed(), hn::TableLookupBytes(all, hn::Load(d, kResults<L>.samples)));
}

// Loads 16 bytes for each lane from its offset on; of `offsets` every `kEvery`th one counts.
template <int kEvery, class D>
HWY_INLINE hn::Vec<D> load_segments(D d, const std::uint8_t* plane, const std::int32_t* offsets) {
  constexpr std::size_t kSize = hn::MaxLanes(D());
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  // Combine() clears a half before it is written, and takes the port that shuffles need.
  if constexpr (kSize == 64) {
    const hn::FixedTag<std::uint8_t, 16> lane;
    const auto at = [&](int l)
                        HWY_ATTR { return hn::LoadU(lane, plane + offsets[kEvery * l]).raw; };
    const auto lo = _mm256_inserti128_si256(_mm256_castsi128_si256(at(0)), at(1), 1);
    const auto hi = _mm256_inserti128_si256(_mm256_castsi128_si256(at(2)), at(3), 1);
    return hn::Vec<D>{_mm512_inserti32x8(_mm512_castsi256_si512(lo), hi, 1)};
  }
#endif
  if constexpr (kSize > 16) {
    const hn::FixedTag<std::uint8_t, kSize / 2> half;
    return hn::Combine(d, load_segments<kEvery>(half, plane, offsets + kEvery * kSize / 32),
                       load_segments<kEvery>(half, plane, offsets));
  } else {
    return hn::LoadU(d, plane + offsets[0]);
  }
}

// Stores a vector of results, as bytes.
template <class L>
HWY_INLINE void store_results(Numbers results, std::uint8_t* out) {
  constexpr std::size_t kHalf = kBytes / 2;
  const hn::FixedTag<std::uint8_t, kHalf> d;
  if constexpr (L::kSampleBytes == 2) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    _mm512_mask_storeu_epi8(out, 0x5555555555555555U, results.raw);
#else
    const Words words;
    auto* at = reinterpret_cast<std::uint16_t*>(out);
    const auto others = hn::And(hn::LoadU(words, at), hn::Set(words, 0xFF00));
    hn::StoreU(hn::Or(others, hn::BitCast(words, results)), words, at);
#endif
  } else if constexpr (L::kStep == 3) {
    // Six of the eight results of a lane are samples: they go to the front, and the next lane is
    // stored over the other two.
    alignas(16) static constexpr std::uint8_t kFront[16] = {0,  1,  2,  3,  4, 5, 8, 9,
                                                            10, 11, 12, 13, 0, 0, 0, 0};
    const Bytes all;
    const auto front = hn::TableLookupBytes(hn::BitCast(all, results), hn::LoadDup128(all, kFront));
    alignas(64) std::uint8_t lanes[kHalf];
    hn::Store(hn::DemoteTo(d, hn::BitCast(Signed(), front)), d, lanes);
    for (int l = 0; l < kLanes; ++l) std::memcpy(out + 6 * l, lanes + 8 * l, 8);
  } else {
    hn::StoreU(hn::DemoteTo(d, results), d, out);
  }
}

// The order of bytes and of 64-bit halves in which store_pair() writes.
struct PairOrder {
  // The lower halves of all lanes, then the upper ones.
  alignas(64) std::uint64_t halves[8] = {0, 2, 4, 6, 1, 3, 5, 7};
  // Six of eight results of a lane are samples of three components.
  alignas(64) std::uint8_t threes[64];
};
constexpr PairOrder make_pair_order() {
  PairOrder order{};
  for (int i = 0; i < 64; ++i) {
    const int lane = i / 6 % 8;
    const int result = i % 6 / 3 * 4 + i % 3;
    order.threes[i] = static_cast<std::uint8_t>(lane % 4 * 16 + lane / 4 * 8 + result);
  }
  return order;
}
constexpr PairOrder kPairOrder = make_pair_order();

// Two vectors that were packed lane by lane: all lanes of the first one, then those of the second.
HWY_INLINE Pairs in_turn(Pairs packed) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  const hn::Repartition<std::uint64_t, Bytes> halves;
  return Pairs{_mm512_permutexvar_epi64(hn::Load(halves, kPairOrder.halves).raw, packed.raw)};
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  return Pairs{_mm256_permute4x64_epi64(packed.raw, 0xD8)};
#else
  return packed;
#endif
}

// Stores two vectors of results that were packed lane by lane.
template <class L>
HWY_INLINE void store_pair(Pairs pair, std::uint8_t* out) {
  const Bytes d;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
  if constexpr (L::kStep == 3) {
    constexpr std::uint64_t kSamples = (std::uint64_t{1} << 48) - 1;
    const auto order = hn::Load(d, kPairOrder.threes);
    _mm512_mask_storeu_epi8(out, kSamples, _mm512_permutexvar_epi8(order.raw, pair.raw));
    return;
  }
#endif
  hn::StoreU(in_turn(pair), d, out);
}

// Loads every second one of the 32 bytes that begin at each lane's offset.
HWY_INLINE Pairs load_every_second(const std::uint8_t* source, const std::int32_t* offsets) {
  const Bytes d;
  const Words words;
  const auto samples = [&](Pairs bytes) HWY_ATTR {
    return hn::BitCast(Signed(), hn::And(hn::BitCast(words, bytes), hn::Set(words, 0xFF)));
  };
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (kLanes == 2) {
    const auto both = pack_lanes(d, samples(hn::LoadU(d, source + offsets[0])),
                                 samples(hn::LoadU(d, source + offsets[1])));
    return in_turn(both);
  }
#endif
  return pack_lanes(d, samples(load_segments<1>(d, source, offsets)),
                    samples(load_segments<1>(d, source + 16, offsets)));
}

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
// Loads the windows of as many runs as fill a vector: one or two.
template <int kWindow>
HWY_INLINE Pairs load_windows(const std::uint8_t* source, const std::int32_t* offsets) {
  const Bytes d;
  if constexpr (kWindow == 64) {
    return hn::LoadU(d, source + offsets[0]);
  } else {
    const hn::FixedTag<std::uint8_t, 32> half;
    return hn::Combine(d, hn::LoadU(half, source + offsets[1]),
                       hn::LoadU(half, source + offsets[0]));
  }
}

// Fetches pairs of neighbours from windows. Highway 1.0.3 has no permutation of all bytes.
template <class L>
HWY_INLINE Pairs fetch_from_windows(const std::uint8_t* source, const std::int32_t* offsets,
                                    Pairs indices) {
  const auto first = load_windows<L::kWindow>(source, offsets).raw;
  const auto pairs = _mm512_permutexvar_epi8(indices.raw, first);
  if constexpr (L::kSampleBytes == 1) {
    return Pairs{pairs};
  } else {
    const auto second = load_windows<L::kWindow>(source, offsets + 64 / L::kWindow).raw;
    return Pairs{_mm512_mask_permutexvar_epi8(pairs, ~0ULL << 32, indices.raw, second)};
  }
}
#endif

// Fetches the pairs of neighbours of a vector of results, whose byte indices are `indices`.
// `offsets` has one number per run where kByWindows, else one per lane.
template <class L>
HWY_INLINE Pairs fetch_pairs(const std::uint8_t* source, const std::int32_t* offsets,
                             Pairs indices) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
  if constexpr (kByWindows<L>) return fetch_from_windows<L>(source, offsets, indices);
#endif
  if constexpr (L::kSampleBytes == 1) {
    return hn::TableLookupBytes(load_segments<L::kEvery>(Bytes(), source, offsets), indices);
  } else {
    return hn::TableLookupBytes(load_every_second(source, offsets), indices);
  }
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
