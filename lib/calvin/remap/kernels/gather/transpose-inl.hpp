// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Transposes gathered pixels: vectors with one pixel of each run become runs in memory. Compiled
// once per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_TRANSPOSE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_TRANSPOSE_INL_HPP
#undef CALVIN_REMAP_TRANSPOSE_INL_HPP
#else
#define CALVIN_REMAP_TRANSPOSE_INL_HPP
#endif

#include <cstring>

#include "calvin/remap/kernels/gather/gather_pixels-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

constexpr int kPixels = 8;                           // of a run
constexpr int kRuns = static_cast<int>(kBytes / 4);  // of a vector

// Joins the first of each two bytes, or of each two 16-bit numbers, of both vectors.
HWY_INLINE hn::Vec<Ints> join_bytes(hn::Vec<Ints> first, hn::Vec<Ints> second) {
  return hn::BitCast(Ints(),
                     even_and_odd(hn::BitCast(Bytes(), first), up(hn::BitCast(Bytes(), second))));
}
HWY_INLINE hn::Vec<Ints> join_words(hn::Vec<Ints> first, hn::Vec<Ints> second) {
  return hn::BitCast(Ints(), hn::OddEven(hn::BitCast(Signed(), hn::ShiftLeft<16>(second)),
                                         hn::BitCast(Signed(), first)));
}

// Transposes a block of pixels. Pixels of 3 and 4 bytes come out as 32-bit words: the first halves
// of all runs, then the second halves.
template <class M>
HWY_INLINE void transpose_block(const std::int32_t* pixels, std::int32_t* to) {
  const Ints d;
  const auto pixel = [&](int i) HWY_ATTR { return hn::Load(d, pixels + i * kRuns); };
  if constexpr (M::kStep == 1) {
    const auto four = [&](int i) HWY_ATTR {
      return join_words(join_bytes(pixel(i), pixel(i + 1)), join_bytes(pixel(i + 2), pixel(i + 3)));
    };
    hn::StoreInterleaved2(four(0), four(4), d, to);
  } else if constexpr (M::kStep == 2) {
    const auto two = [&](int i) HWY_ATTR { return join_words(pixel(i), pixel(i + 1)); };
    hn::StoreInterleaved4(two(0), two(2), two(4), two(6), d, to);
  } else {
    for (int i = 0; i < kPixels; i += 4) {
      hn::StoreInterleaved4(pixel(i), pixel(i + 1), pixel(i + 2), pixel(i + 3), d, to + i * kRuns);
    }
  }
}

// Copies sixteen bytes of transpose_block() to the output. Bytes between spaced components must
// stay as they are: they belong to other planes.
template <class M>
HWY_INLINE void put_pixels(const std::int32_t* from, std::uint8_t* to) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(from);
  if constexpr (M::kStrided) {
    HWY_UNROLL(8)
    for (int i = 0; i < 16; i += 2) to[i] = bytes[i];
  } else if constexpr (M::kStep == 3) {
    alignas(16) static constexpr std::uint8_t kFront[16] = {0,  1,  2,  4,  5, 6, 8, 9,
                                                            10, 12, 13, 14, 0, 0, 0, 0};
    const hn::FixedTag<std::uint8_t, 16> d;
    alignas(16) std::uint8_t front[16];
    hn::Store(hn::TableLookupBytes(hn::Load(d, bytes), hn::Load(d, kFront)), d, front);
    std::memcpy(to, front, 12);
  } else {
    std::memcpy(to, bytes, 16);
  }
}

// Copies the `r`th of the runs of transpose_block() to the output.
template <class M>
HWY_INLINE void put_run(const std::int32_t* from, int r, std::uint8_t* to) {
  if constexpr (M::kStep == 1) {
    std::memcpy(to, from + 2 * r, kPixels);
  } else if constexpr (M::kStep == 2) {
    put_pixels<M>(from + 4 * r, to);
  } else {
    put_pixels<M>(from + 4 * r, to);
    put_pixels<M>(from + 4 * (r + kRuns), to + 4 * M::kStep);
  }
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
