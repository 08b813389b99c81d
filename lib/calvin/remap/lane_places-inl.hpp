// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where each of the eight samples of a run comes from, for kernels that fetch them one by one: in
// single precision from the sample that the run's middle is behind. Compiled once per target of
// Highway: include it after hwy/foreach_target.h.
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

constexpr int kPixels = 8;
// A vector holds all samples of a run or a part of them.
using PlaceFloats = hn::CappedTag<float, kPixels>;
using PlaceInts = hn::RebindToSigned<PlaceFloats>;

// Along one axis: whole samples, and the rest.
struct RunPlaces {
  hn::Vec<PlaceInts> whole;
  hn::Vec<PlaceFloats> rest;
};

// Of a vector of samples whose first one is `first` in the run.
HWY_INLINE RunPlaces places_at(const RunParabola& parabola, int first, bool nearest) {
  const PlaceFloats d;
  const PlaceInts ints;
  const double base = std::floor(parabola.middle);
  const auto t = hn::Iota(d, static_cast<float>(first) - (kPixels - 1) / 2.0F);
  const auto at = hn::MulAdd(t,
                             hn::MulAdd(t, hn::Set(d, static_cast<float>(parabola.bend)),
                                        hn::Set(d, static_cast<float>(parabola.slope))),
                             hn::Set(d, static_cast<float>(parabola.middle - base)));
  const auto down = hn::Floor(at);
  const auto rest = at - down;
  const auto whole = hn::ConvertTo(ints, down) + hn::Set(ints, static_cast<std::int32_t>(base));
  return {whole, nearest ? hn::Round(rest) : rest};
}

// Whether all places have `before` samples before them and `behind` behind, of which the last one
// is `last`.
HWY_INLINE bool are_within(const RunPlaces& places, int before, int behind, std::int32_t last) {
  const PlaceInts d;
  const auto held = hn::Max(places.whole, hn::Set(d, before));
  return hn::AllTrue(d, hn::Eq(places.whole, hn::Min(held, hn::Set(d, last - behind))));
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
