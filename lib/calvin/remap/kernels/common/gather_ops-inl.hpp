// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Gathers: vectors of 32 or 64 bits from any addresses, and the samples in them as numbers of
// single precision. Compiled once per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_GATHER_OPS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_GATHER_OPS_INL_HPP
#undef CALVIN_REMAP_GATHER_OPS_INL_HPP
#else
#define CALVIN_REMAP_GATHER_OPS_INL_HPP
#endif

#include "calvin/core/vector_targets.hpp"
#include "calvin/remap/kernels/common/pixel_layout.hpp"
// After vector_targets.hpp.
#include <hwy/highway.h>

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Loads a number of D from each offset, or with kEvery = 2 from every second one. It is done with
// plain loads: on most machines the instructions that gather take longer.
template <int kEvery = 1, class D>
HWY_INLINE hn::Vec<D> load_each(D d, const std::uint8_t* from, const std::int32_t* offsets) {
  constexpr std::size_t kCount = hn::MaxLanes(D());
  if constexpr (kCount == 1) {
    return hn::LoadU(d, reinterpret_cast<const hn::TFromD<D>*>(from + offsets[0]));
  } else {
    const hn::Half<D> half;
    const auto upper = load_each<kEvery>(half, from, offsets + kEvery * kCount / 2);
    return hn::Combine(d, upper, load_each<kEvery>(half, from, offsets));
  }
}

// Swaps the two bytes of each 16-bit half.
template <class V>
HWY_INLINE V swap_bytes(V pairs) {
  const auto bytes = hn::Set(hn::DFromV<V>(), 0x00FF00FF);
  return hn::Or(hn::ShiftLeft<8>(hn::And(pairs, bytes)), hn::And(hn::ShiftRight<8>(pairs), bytes));
}

// The value that begins at bit `bit` of each 32 bits: a byte, or a word of that format.
template <bool kWords, class V>
HWY_INLINE auto value_at(V memory, WordFormat format, int bit) {
  const hn::DFromV<V> d;
  if constexpr (kWords) {
    if (format.swapped) memory = swap_bytes(memory);
  }
  auto value = hn::And(hn::ShiftRightSame(memory, bit), hn::Set(d, kWords ? 0xFFFF : 0xFF));
  if constexpr (kWords) value = hn::ShiftRightSame(value, format.shift);
  const hn::RebindToSigned<decltype(d)> numbers;
  return hn::ConvertTo(hn::RebindToFloat<decltype(d)>(), hn::BitCast(numbers, value));
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
