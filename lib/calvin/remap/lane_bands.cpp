// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a few rows of runs have in common, for every instruction set.

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"

#include <algorithm>
#include <iterator>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_bands.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_curves-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void begin_band_of(int /*run*/, const SourceBounds& /*bounds*/, const NodeRows& /*nodes*/,
                   int /*slot*/, float /*height*/, Band& /*band*/, RunRow& /*row*/) {}

#else

// How far places of a steady band are from a line down it, 1/2^14 of a sample.
constexpr std::int32_t kMostBulge = 1 << (kPlaceBits - 2);

// How much the bend of runs changes in a steady band, which takes one for all rows; 4.12.
constexpr std::int32_t kMostChange = 3;

// One axis of a vector of runs, in the first and in the last row of a band.
struct BandAxis {
  hn::Vec<Ints> half;
  hn::Vec<Ints> bend;
  hn::Vec<Ints> changed;  // the bend, between the two rows
  hn::Vec<Ints> least;    // place
  hn::Vec<Ints> most;
  hn::Vec<Ints> steep;
};
// Between four nodes a column is a cubic, whose second derivative goes straight from the second
// difference at the second node to that at the third: how far the middles of the band's rows are
// from a line between its ends at most.
HWY_INLINE hn::Vec<Ints> bulge(const float (&rows)[4][NodeRows::kRuns], int j, int slot,
                               float height) {
  const Floats d;
  const auto node = [&](int r) HWY_ATTR { return hn::LoadU(d, rows[(slot + r) % 4] + j); };
  const auto upper = node(0) - node(1) - node(1) + node(2);
  const auto lower = node(1) - node(2) - node(2) + node(3);
  const auto most = hn::Max(hn::Abs(upper), hn::Abs(lower)) * hn::Set(d, height * height / 8);
  // No number is beyond all bounds.
  return hn::NearestInt(hn::Min(most, hn::Set(d, 1e9F))) + hn::Set(Ints(), 64);
}

// `reach` is how far from a middle the source is looked at, whether its run needs it or not.
template <bool kThird>
HWY_INLINE BandAxis band_axis(const std::int32_t* first, const std::int32_t* last,
                              hn::Vec<Ints> slack, std::int32_t reach) {
  const Line a = line_of<8>(curve_at<kThird>(first));
  const Line b = line_of<8>(curve_at<kThird>(last));
  // Of a vector that is not steady it may be anything.
  const auto half = hn::Max(half_of<8>(a), half_of<8>(b)) + slack;
  const auto around = hn::Max(half, hn::Set(Ints(), reach)) + slack;
  return {half,
          hn::ShiftRight<1>(a.bend + b.bend),
          hn::Abs(a.bend - b.bend),
          hn::Min(a.middle, b.middle) - around,
          hn::Max(a.middle, b.middle) + around,
          hn::Max(hn::Abs(a.slope), hn::Abs(b.slope))};
}

// Whether none of a vector of runs needs to be looked at again in the band: three rows, and far
// from the ends of the source.
HWY_INLINE bool is_steady(const BandAxis& x, const BandAxis& y, const SourceBounds& b) {
  const Ints d;
  const auto last = [&](const BandAxis& axis)
                        HWY_ATTR { return hn::ShiftRight<kPlaceBits>(axis.most); };
  // Of three rows that begin half a row before the middle, the last one is behind the row of
  // `most`.
  const auto last_row = hn::Set(d, std::min(b.last_row - 1, b.rows - b.guarded_rows - 2));
  // Slopes change within the band.
  const auto x_room = hn::Set(d, b.steepest - 0x400) - x.steep - hn::ShiftLeft<3>(hn::Abs(x.bend));
  const auto columns = hn::ShiftRight<kPlaceBits - 1>(x.half);
  auto spare = hn::Min(hn::Min(x.least, y.least), hn::Min(x_room, hn::Set(d, kHalfRow) - y.half));
  spare = hn::Min(spare, hn::Min(hn::Set(d, b.last_column - 1) - last(x), last_row - last(y)));
  spare = hn::Min(spare, hn::Min(hn::Set(d, b.widest - 2) - columns,
                                 hn::Set(d, kMostChange) - hn::Max(x.changed, y.changed)));
  return hn::AllFalse(d, hn::Lt(spare, hn::Zero(d)));
}

template <bool kThird>
HWY_INLINE void begin_bands(const SourceBounds& bounds, const NodeRows& nodes, int slot,
                            float height, Band& band, RunRow& row) {
  const Ints d;
  constexpr int kVector = static_cast<int>(hn::MaxLanes(Ints()));
  const auto most = hn::Set(d, kMostBulge);
  for (int j = 0; j < row.count; j += kVector) {
    const auto x_bulge = bulge(nodes.x, j + kMargin, slot, height);
    const auto y_bulge = bulge(nodes.y, j + kMargin, slot, height);
    const BandAxis x =
        band_axis<kThird>(band.x_first + j, band.x_last + j, hn::Min(x_bulge, most), 0);
    const BandAxis y =
        band_axis<kThird>(band.y_first + j, band.y_last + j, hn::Min(y_bulge, most), kHalfRow);
    band.steady[j] =
        hn::AllFalse(d, hn::Gt(hn::Max(x_bulge, y_bulge), most)) && is_steady(x, y, bounds);
    if (!band.steady[j]) continue;
    hn::Store(x.half, d, band.x_half + j);
    hn::Store(x.half + hn::Set(d, 2) + hn::ShiftLeft<1>(x.bend), d, band.x_shift + j);
    hn::Store(hn::ShiftLeft<1>(y.bend) - hn::Set(d, kHalfRow), d, band.y_shift + j);
    hn::Store(hn::Set(d, 3), d, row.rows + j);
    hn::Store(packed(x.bend, hn::ShiftLeft<19>(y.bend)), d, row.bend + j);
  }
}

void begin_band_of(int run, const SourceBounds& bounds, const NodeRows& nodes, int slot,
                   float height, Band& band, RunRow& row) {
  if (run != 8) {
    std::fill(std::begin(band.steady), std::end(band.steady), false);
    return;
  }
  bounds.strongly_bent ? begin_bands<true>(bounds, nodes, slot, height, band, row)
                       : begin_bands<false>(bounds, nodes, slot, height, band, row);
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(begin_band_of);

void begin_band(int run, const SourceBounds& bounds, const NodeRows& nodes, int slot, float height,
                Band& band, RunRow& row) noexcept {
  HWY_DYNAMIC_DISPATCH(begin_band_of)(run, bounds, nodes, slot, height, band, row);
}

}  // namespace calvin::remap
#endif
