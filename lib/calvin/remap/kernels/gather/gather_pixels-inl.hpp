// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of pixels of any memory layout, each gathered from its own address: a vector
// has a pixel in each of its 32-bit numbers. Compiled once per target of Highway: include it after
// hwy/foreach_target.h.
#if defined(CALVIN_REMAP_GATHER_PIXELS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_GATHER_PIXELS_INL_HPP
#undef CALVIN_REMAP_GATHER_PIXELS_INL_HPP
#else
#define CALVIN_REMAP_GATHER_PIXELS_INL_HPP
#endif

#include <array>

#include "calvin/remap/kernels/common/blend_math-inl.hpp"
#include "calvin/remap/kernels/common/gather_ops-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

using Unsigned = hn::RebindToUnsigned<Ints>;

// The source plane that pixels are gathered from.
struct SourcePlane {
  const std::uint8_t* source;
  const std::uint8_t* second_row;  // a pointer, lest compilers add the stride to each offset
  std::int32_t stride;
  hn::Vec<Unsigned> last_offset;  // a pixel farther on may be read beyond the end of the plane
  Blender<Bytes> blender;
  WordFormat format;
};

// Loads 32 bits for each pixel, from its offset on.
HWY_INLINE Pairs gather(const std::uint8_t* from, const std::int32_t* offsets) {
  return hn::BitCast(Bytes(), load_each(Ints(), from, offsets));
}

// Loads 32 bits for each pixel from its offset on, and 32 bits from `kStep` bytes behind it on.
template <int kStep>
HWY_INLINE std::array<Pairs, 2> gather_two(const std::uint8_t* from, const std::int32_t* offsets) {
  const hn::RepartitionToWide<Unsigned> d;
  const auto even = load_each<2>(d, from, offsets);
  const auto odd = load_each<2>(d, from, offsets + 1);
  const auto in_turn = [&](auto of_odd, auto of_even) HWY_ATTR {
    return hn::BitCast(
        Bytes(), hn::OddEven(hn::BitCast(Unsigned(), of_odd), hn::BitCast(Unsigned(), of_even)));
  };
  return {in_turn(hn::ShiftLeft<32>(odd), even),
          in_turn(hn::ShiftLeft<32 - 8 * kStep>(odd), hn::ShiftRight<8 * kStep>(even))};
}

// The even bytes of the one, and the odd bytes of the other.
HWY_INLINE Pairs even_and_odd(Pairs even, Pairs odd) { return hn::OddEven(odd, even); }
// Moves even bytes to the odd places behind them, or odd bytes to the even places before them; the
// others are lost.
HWY_INLINE Pairs up(Pairs v) {
  return hn::BitCast(Bytes(), hn::ShiftLeft<8>(hn::BitCast(Words(), v)));
}
HWY_INLINE Pairs down(Pairs v) {
  return hn::BitCast(Bytes(), hn::ShiftRight<8>(hn::BitCast(Words(), v)));
}

// 32-bit numbers that fit into 16 bits, each of them twice.
HWY_INLINE Numbers twice(hn::Vec<Ints> numbers) {
  return hn::BitCast(Signed(), hn::OddEven(hn::BitCast(Signed(), hn::ShiftLeft<16>(numbers)),
                                           hn::BitCast(Signed(), numbers)));
}
// A weight in 1.15, where `value` is 2^15 times as large.
HWY_INLINE Numbers weight_of(hn::Vec<Floats> value) {
  return twice(hn::Min(small_ints(value), hn::Set(Ints(), 0x7FFF)));
}

// Pixels of bytes that are `kSpacing` apart.
template <int kComponents, int kSpacing>
struct GatherBytes {
  static constexpr int kStep = kComponents * kSpacing;
  static constexpr bool kStrided = kSpacing > 1;
  // Whether 32 bits hold a pixel and its neighbour; else 64 do.
  static constexpr bool kNarrow = kStep <= 2;
  // Bytes that are loaded for a pixel, and bytes from its first to its last.
  static constexpr int kFetch = kNarrow ? 4 : 8;
  static constexpr int kOwn = (kComponents - 1) * kSpacing + 1;
  // A 32-bit number has room for the pairs of neighbours of two components: 0 and 1 where there are
  // two; else one vector has 0 and 2, a second one 1 and 3.
  static constexpr int kVectors = kComponents > 2 ? 2 : 1;
  using Components = std::array<Numbers, kVectors>;

  // Blends pixels at the offsets `at` across with their right neighbours.
  static HWY_INLINE Components row(const SourcePlane& source_plane, const std::uint8_t* from,
                                   const std::int32_t* at, Numbers across) {
    alignas(16) static constexpr std::uint8_t kToPairs[16] = {0, 2,  1, 3,  4,  6,  5,  7,
                                                              8, 10, 9, 11, 12, 14, 13, 15};
    const Blender<Bytes>& blender = source_plane.blender;
    if constexpr (kStep == 1) {
      return {blender.across(gather(from, at), across)};
    } else if constexpr (kNarrow) {
      const auto pairs = hn::TableLookupBytes(gather(from, at), hn::LoadDup128(Bytes(), kToPairs));
      return {blender.across(pairs, across)};
    } else {
      const auto [first, second] = gather_two<kStep>(from, at);
      const Numbers even = blender.across(even_and_odd(first, up(second)), across);
      if constexpr (kVectors == 1)
        return {even};
      else
        return {even, blender.across(even_and_odd(down(first), second), across)};
    }
  }

  // The components in the order of memory; other bytes are undefined.
  static HWY_INLINE hn::Vec<Ints> memory_of(const Components& values) {
    const Pairs first = hn::BitCast(Bytes(), values[0]);
    if constexpr (kVectors == 2) {
      return hn::BitCast(Ints(), even_and_odd(first, up(hn::BitCast(Bytes(), values[1]))));
    } else if constexpr (kComponents == 2 && !kStrided) {
      const auto both = hn::BitCast(Ints(), values[0]);
      return hn::Or(both, hn::ShiftRight<8>(both));
    } else {
      return hn::BitCast(Ints(), first);
    }
  }

  // The pixels at the offsets `at`, as in memory; `right` and `below` are the neighbours' weights.
  static HWY_INLINE hn::Vec<Ints> pixels(const SourcePlane& source_plane, const std::int32_t* at,
                                         hn::Vec<Floats> right, hn::Vec<Floats> below) {
    const Floats d;
    const Numbers across = weight_of(hn::MulSub(right, hn::Set(d, 65536), hn::Set(d, 32768)));
    const Numbers weight = weight_of(below * hn::Set(d, 32768));
    const Components upper = row(source_plane, source_plane.source, at, across);
    const Components lower = row(source_plane, source_plane.second_row, at, across);
    Components values;
    for (std::size_t v = 0; v < values.size(); ++v) {
      values[v] = source_plane.blender.rounded(Blender<Bytes>::between(upper[v], lower[v], weight));
    }
    return memory_of(values);
  }
};

// As GatherBytes, for pixels of 16-bit samples, which are blended in single precision.
template <int kComponents>
struct GatherWords {
  static constexpr int kStep = 2 * kComponents;
  static constexpr bool kStrided = false;
  static constexpr int kFetch = 2 * kStep;
  static constexpr int kOwn = kStep;
  using Values = hn::Vec<Floats>;
  using Components = std::array<Values, kComponents>;

  static HWY_INLINE Values between(Values a, Values b, Values weight) {
    return hn::MulAdd(weight, b - a, a);
  }

  static HWY_INLINE Components row(const SourcePlane& source_plane, const std::uint8_t* from,
                                   const std::int32_t* at, Values across) {
    const auto value = [&](Pairs memory, int bit) HWY_ATTR {
      return value_at<true>(hn::BitCast(Unsigned(), memory), source_plane.format, bit);
    };
    if constexpr (kComponents == 1) {
      const Pairs both = gather(from, at);
      return {between(value(both, 0), value(both, 16), across)};
    } else {
      const auto [first, second] = gather_two<kStep>(from, at);
      return {between(value(first, 0), value(second, 0), across),
              between(value(first, 16), value(second, 16), across)};
    }
  }

  static HWY_INLINE hn::Vec<Ints> pixels(const SourcePlane& source_plane, const std::int32_t* at,
                                         Values right, Values below) {
    const Components upper = row(source_plane, source_plane.source, at, right);
    const Components lower = row(source_plane, source_plane.second_row, at, right);
    const auto word = [&](std::size_t c) HWY_ATTR {
      const auto value = small_ints(between(upper[c], lower[c], below));
      return hn::ShiftLeftSame(hn::BitCast(Unsigned(), value), source_plane.format.shift);
    };
    auto memory = word(0);
    if constexpr (kComponents == 2) memory = hn::Or(memory, hn::ShiftLeft<16>(word(1)));
    return hn::BitCast(Ints(), source_plane.format.swapped ? swap_bytes(memory) : memory);
  }
};

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
