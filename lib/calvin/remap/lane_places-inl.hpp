// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where each of the eight samples of a run comes from, for kernels that gather: in single precision
// from the sample that the run's middle is behind. Compiled once per target of Highway: include it
// after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_LANE_PLACES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_LANE_PLACES_INL_HPP
#undef CALVIN_REMAP_LANE_PLACES_INL_HPP
#else
#define CALVIN_REMAP_LANE_PLACES_INL_HPP
#endif

#include <cmath>

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"
// After lane_targets.hpp.
#include <hwy/highway.h>

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A vector holds all samples of a run or a part of them.
constexpr int kPixels = 8;
using Floats = hn::CappedTag<float, kPixels>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using Values = hn::Vec<Floats>;

// Along one axis: whole samples, and the rest.
struct Places {
  hn::Vec<Ints> whole;
  Values rest;
};

// Of a vector of samples whose first one is `first` in the run.
HWY_INLINE Places places_at(const RunParabola& parabola, int first, bool nearest) {
  const Floats d;
  const double base = std::floor(parabola.middle);
  const auto t = hn::Iota(d, static_cast<float>(first) - (kPixels - 1) / 2.0F);
  const auto at = hn::MulAdd(t,
                             hn::MulAdd(t, hn::Set(d, static_cast<float>(parabola.bend)),
                                        hn::Set(d, static_cast<float>(parabola.slope))),
                             hn::Set(d, static_cast<float>(parabola.middle - base)));
  const auto down = hn::Floor(at);
  const auto rest = at - down;
  const auto whole = hn::ConvertTo(Ints(), down) + hn::Set(Ints(), static_cast<std::int32_t>(base));
  return {whole, nearest ? hn::Round(rest) : rest};
}

// Both bytes of each 16-bit half change places.
HWY_INLINE hn::Vec<Words> swap_bytes(hn::Vec<Words> pairs) {
  const auto bytes = hn::Set(Words(), 0x00FF00FF);
  return hn::Or(hn::ShiftLeft<8>(hn::And(pairs, bytes)), hn::And(hn::ShiftRight<8>(pairs), bytes));
}

// The value that begins at a bit of 32 in memory: a byte, or a word of that format.
template <bool kWords>
HWY_INLINE Values value_at(hn::Vec<Words> memory, WordFormat format, int bit) {
  const Words d;
  if constexpr (kWords) {
    if (format.swapped) memory = swap_bytes(memory);
  }
  auto value = hn::And(hn::ShiftRightSame(memory, bit), hn::Set(d, kWords ? 0xFFFF : 0xFF));
  if constexpr (kWords) value = hn::ShiftRightSame(value, format.shift);
  return hn::ConvertTo(Floats(), hn::BitCast(Ints(), value));
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
