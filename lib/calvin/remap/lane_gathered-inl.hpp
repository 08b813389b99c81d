// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of pixels of any memory layout that are gathered, each by its own address: a
// vector of 32-bit numbers has one pixel in each. Compiled once per target of Highway: include it
// after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_LANE_GATHERED_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_LANE_GATHERED_INL_HPP
#undef CALVIN_REMAP_LANE_GATHERED_INL_HPP
#else
#define CALVIN_REMAP_LANE_GATHERED_INL_HPP
#endif

#include <array>

#include "calvin/remap/lane_gathers-inl.hpp"
#include "calvin/remap/lane_math-inl.hpp"

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

using Unsigned = hn::RebindToUnsigned<Ints>;

// What the pixels are fetched from.
struct Picture {
  const std::uint8_t* source;
  const std::uint8_t* second_row;  // nothing that compilers add to each offset
  std::int32_t stride;
  hn::Vec<Unsigned> last_offset;  // behind which something may be read that is not the plane's
  Blender<Bytes> blender;
  WordFormat format;
};

// 32 bits of each, from its offset on.
HWY_INLINE Pairs gather(const std::uint8_t* from, const std::int32_t* offsets) {
  return hn::BitCast(Bytes(), load_each(Ints(), from, offsets));
}

// 32 bits of each from its offset on, and 32 from `kStep` bytes behind that on.
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

// Bytes at even places from the one, and at odd ones from the other.
HWY_INLINE Pairs even_and_odd(Pairs even, Pairs odd) { return hn::OddEven(odd, even); }
HWY_INLINE Pairs up(Pairs v) {
  return hn::BitCast(Bytes(), hn::ShiftLeft<8>(hn::BitCast(Words(), v)));
}
HWY_INLINE Pairs down(Pairs v) {
  return hn::BitCast(Bytes(), hn::ShiftRight<8>(hn::BitCast(Words(), v)));
}

// 32-bit numbers that fit into 16, twice each.
HWY_INLINE Numbers twice(hn::Vec<Ints> numbers) {
  return hn::BitCast(Signed(), hn::OddEven(hn::BitCast(Signed(), hn::ShiftLeft<16>(numbers)),
                                           hn::BitCast(Signed(), numbers)));
}
// 1.15.
HWY_INLINE Numbers weight_of(hn::Vec<Floats> value) {
  return twice(hn::Min(small_ints(value), hn::Set(Ints(), 0x7FFF)));
}

// Pixels of bytes that are `kSpacing` apart.
template <int kComponents, int kSpacing>
struct GatheredBytes {
  static constexpr int kStep = kComponents * kSpacing;
  static constexpr bool kSpread = kSpacing > 1;
  // Whether 32 bits hold a pixel and its neighbour; else 64 do.
  static constexpr bool kNarrow = kStep <= 2;
  // Bytes that are fetched for a pixel, and those that it has.
  static constexpr int kFetch = kNarrow ? 4 : 8;
  static constexpr int kOwn = (kComponents - 1) * kSpacing + 1;
  // Two components fit into a 32-bit number as pairs of neighbours: 0 and 1 of two, 0 and 2, 1 and
  // 3 of more.
  static constexpr int kVectors = kComponents > 2 ? 2 : 1;
  using Components = std::array<Numbers, kVectors>;

  // A row of pixels that are `across` from `at` to their neighbours.
  static HWY_INLINE Components row(const Picture& picture, const std::uint8_t* from,
                                   const std::int32_t* at, Numbers across) {
    alignas(16) static constexpr std::uint8_t kTurned[16] = {0, 2,  1, 3,  4,  6,  5,  7,
                                                             8, 10, 9, 11, 12, 14, 13, 15};
    const Blender<Bytes>& blender = picture.blender;
    if constexpr (kStep == 1) {
      return {blender.across(gather(from, at), across)};
    } else if constexpr (kNarrow) {
      const auto turned = hn::TableLookupBytes(gather(from, at), hn::LoadDup128(Bytes(), kTurned));
      return {blender.across(turned, across)};
    } else {
      const auto [first, second] = gather_two<kStep>(from, at);
      const Numbers even = blender.across(even_and_odd(first, up(second)), across);
      if constexpr (kVectors == 1)
        return {even};
      else
        return {even, blender.across(even_and_odd(down(first), second), across)};
    }
  }

  // In the order of memory; what is not theirs is anything.
  static HWY_INLINE hn::Vec<Ints> memory_of(const Components& values) {
    const Pairs first = hn::BitCast(Bytes(), values[0]);
    if constexpr (kVectors == 2) {
      return hn::BitCast(Ints(), even_and_odd(first, up(hn::BitCast(Bytes(), values[1]))));
    } else if constexpr (kComponents == 2 && !kSpread) {
      const auto both = hn::BitCast(Ints(), values[0]);
      return hn::Or(both, hn::ShiftRight<8>(both));
    } else {
      return hn::BitCast(Ints(), first);
    }
  }

  static HWY_INLINE hn::Vec<Ints> pixels(const Picture& picture, const std::int32_t* at,
                                         hn::Vec<Floats> right, hn::Vec<Floats> below) {
    const Floats d;
    const Numbers across = weight_of(hn::MulSub(right, hn::Set(d, 65536), hn::Set(d, 32768)));
    const Numbers weight = weight_of(below * hn::Set(d, 32768));
    const Components upper = row(picture, picture.source, at, across);
    const Components lower = row(picture, picture.second_row, at, across);
    Components values;
    for (std::size_t v = 0; v < values.size(); ++v) {
      values[v] = picture.blender.rounded(Blender<Bytes>::between(upper[v], lower[v], weight));
    }
    return memory_of(values);
  }
};

// Pixels of 16-bit samples, blended in single precision.
template <int kComponents>
struct GatheredWords {
  static constexpr int kStep = 2 * kComponents;
  static constexpr bool kSpread = false;
  static constexpr int kFetch = 2 * kStep;
  static constexpr int kOwn = kStep;
  using Values = hn::Vec<Floats>;
  using Components = std::array<Values, kComponents>;

  static HWY_INLINE Values between(Values a, Values b, Values weight) {
    return hn::MulAdd(weight, b - a, a);
  }

  static HWY_INLINE Components row(const Picture& picture, const std::uint8_t* from,
                                   const std::int32_t* at, Values across) {
    const auto value = [&](Pairs memory, int bit) HWY_ATTR {
      return value_at<true>(hn::BitCast(Unsigned(), memory), picture.format, bit);
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

  static HWY_INLINE hn::Vec<Ints> pixels(const Picture& picture, const std::int32_t* at,
                                         Values right, Values below) {
    const Components upper = row(picture, picture.source, at, right);
    const Components lower = row(picture, picture.second_row, at, right);
    const auto word = [&](std::size_t c) HWY_ATTR {
      const auto value = small_ints(between(upper[c], lower[c], below));
      return hn::ShiftLeftSame(hn::BitCast(Unsigned(), value), picture.format.shift);
    };
    auto memory = word(0);
    if constexpr (kComponents == 2) memory = hn::Or(memory, hn::ShiftLeft<16>(word(1)));
    return hn::BitCast(Ints(), picture.format.swapped ? swap_bytes(memory) : memory);
  }
};

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
