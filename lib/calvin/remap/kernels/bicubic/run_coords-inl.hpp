// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The source coordinates of the eight samples of a run in single precision, for the bicubic kernel.
// Compiled once per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_RUN_COORDS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_RUN_COORDS_INL_HPP
#undef CALVIN_REMAP_RUN_COORDS_INL_HPP
#else
#define CALVIN_REMAP_RUN_COORDS_INL_HPP
#endif

#include "calvin/core/vector_targets.hpp"
#include "calvin/remap/map/runs.hpp"
// After vector_targets.hpp.
#include <hwy/highway.h>

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kPixels = 8;
// A vector holds all samples of a run or a part of them.
using CoordFloats = hn::CappedTag<float, kPixels>;
using CoordInts = hn::RebindToSigned<CoordFloats>;

// RunParabola of eight samples, counted from `base`, the whole sample before the run's middle:
// single precision suffices for coordinates that near.
struct RunCurve {
  explicit RunCurve(const std::int32_t* middles) noexcept {
    const RunParabola parabola(middles, kPixels);
    base = middles[kMargin] >> kCoordBits;
    rest = static_cast<float>(parabola.middle - base);
    slope = static_cast<float>(parabola.slope);
    bend = static_cast<float>(parabola.bend);
  }

  std::int32_t base;
  float rest;
  float slope;
  float bend;
};

// Source coordinates along one axis: whole samples, and the rest, 0..1.
struct RunCoords {
  hn::Vec<CoordInts> whole;
  hn::Vec<CoordFloats> rest;
};

// Samples from the middle of a run; Highway's Iota() is a loop with some instruction sets.
alignas(32) constexpr float kFromMiddle[kPixels] = {-3.5F, -2.5F, -1.5F, -0.5F,
                                                    0.5F,  1.5F,  2.5F,  3.5F};

// The coordinates of a vector of samples that begins with the run's sample `first`.
HWY_INLINE RunCoords coords_at(const RunCurve& curve, int first, bool nearest) {
  const CoordFloats d;
  const CoordInts ints;
  const auto t = hn::Load(d, kFromMiddle + first);
  const auto at = hn::MulAdd(t, hn::MulAdd(t, hn::Set(d, curve.bend), hn::Set(d, curve.slope)),
                             hn::Set(d, curve.rest));
  const auto down = hn::Floor(at);
  const auto rest = at - down;
  return {hn::ConvertTo(ints, down) + hn::Set(ints, curve.base), nearest ? hn::Round(rest) : rest};
}

// Whether all coordinates have `before` samples before them and `behind` samples behind them, where
// the axis has the samples 0..last.
HWY_INLINE bool are_within(const RunCoords& coords, int before, int behind, std::int32_t last) {
  const CoordInts d;
  const auto held = hn::Max(coords.whole, hn::Set(d, before));
  return hn::AllTrue(d, hn::Eq(coords.whole, hn::Min(held, hn::Set(d, last - behind))));
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
