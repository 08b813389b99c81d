// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Preparation of a row of lanes: where each lies in the source, for every instruction set.

#include "calvin/remap/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_rows.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every lane is slow.

void interpolate_row(const NodeRows& nodes, const float* weights, int count, LaneRow& row) {
  row.count = count;
  for (int j = 0; j < count + 2 * kMargin + kSpare; ++j) {
    float x = 0;
    float y = 0;
    for (int r = 0; r < 4; ++r) {
      x += weights[r] * nodes.x[r][j];
      y += weights[r] * nodes.y[r][j];
    }
    row.x[j] = static_cast<std::int32_t>(std::lrint(x));
    row.y[j] = static_cast<std::int32_t>(std::lrint(y));
  }
}

void describe_row(LaneLayout /*layout*/, const SourceBounds& /*bounds*/, LaneRow& row) {
  std::fill_n(row.rows, row.count, kSlowLane);
}

int group() { return 1; }

#else

// ---- Preparation: vectors of 32-bit numbers, one per lane.

// Places of 4.12 reach over 16 rows.
constexpr std::int32_t kMostRows = 15;

template <int kPixels>
struct Parabola {
  // Second difference of the middles -> what the parabola adds at the ends of a lane, 4.12.
  static constexpr int kFactor = kPixels == 8 ? 49 : kPixels == 4 ? 9 : 1;
  static constexpr int kShift = kPixels == 8 ? 11 : kPixels == 4 ? 9 : 7;
  // Difference of the neighbours' middles -> slope, 2.14.
  static constexpr int kSlopeShift = kPixels == 8 ? 4 : kPixels == 4 ? 3 : 2;
};

struct Axis {
  hn::Vec<Ints> first;  // sample
  hn::Vec<Ints> last;   // sample that the last place has for a neighbour
  hn::Vec<Ints> line;   // as in LaneRow
  hn::Vec<Ints> bend;   // 4.12
  hn::Vec<Ints> steep;  // size of the slope, 2.14
};

// `places` of two lanes before, of the lane, and of two behind.
template <int kPixels, bool kThird>
HWY_INLINE Axis describe(const std::int32_t* places) {
  using P = Parabola<kPixels>;
  const Ints d;
  const auto before = hn::LoadU(d, places + 1);
  const auto middle = hn::LoadU(d, places + 2);
  const auto after = hn::LoadU(d, places + 3);
  const auto second = before + after - middle - middle;
  const auto bend = hn::ShiftRight<P::kShift>(second * hn::Set(d, P::kFactor));
  auto across = after - before;
  if constexpr (kThird) {
    const auto third = hn::LoadU(d, places + 4) - hn::Load(d, places) - across - across;
    across = across - hn::ShiftRight<8>(third * hn::Set(d, kThirdPart));
  }
  const auto slope = hn::ShiftRight<P::kSlopeShift>(across);
  Axis axis;
  axis.steep = hn::Abs(slope);
  const auto half = hn::ShiftRight<1>(axis.steep * hn::Set(d, reach(kPixels))) +
                    hn::ShiftLeft<2>(hn::Abs(bend)) + hn::Set(d, 16);
  axis.first = hn::ShiftRight<kPlaceBits>(middle - half);
  axis.last = hn::ShiftRight<kPlaceBits>(middle + half) + hn::Set(d, 1);
  const auto centre =
      middle + hn::ShiftLeft<1>(bend) + hn::Set(d, 2) - hn::ShiftLeft<kPlaceBits>(axis.first);
  const auto low = hn::Set(d, 0xFFFF);
  axis.line = hn::Or(hn::And(hn::ShiftRight<2>(centre), low), hn::ShiftLeft<16>(slope));
  axis.bend = bend;
  return axis;
}

// The largest of the lanes that make a vector, in each of them.
HWY_INLINE hn::Vec<Ints> group_maximum(hn::Vec<Ints> rows) {
  if constexpr (kLanes >= 2) rows = hn::Max(rows, hn::Shuffle2301(rows));
  if constexpr (kLanes >= 4) rows = hn::Max(rows, hn::Shuffle1032(rows));
  return rows;
}

HWY_INLINE void interpolate(const float (&rows)[4][NodeRows::kLanes], const float* weights,
                            int count, std::int32_t* places) {
  const Floats d;
  const auto w0 = hn::Set(d, weights[0]);
  const auto w1 = hn::Set(d, weights[1]);
  const auto w2 = hn::Set(d, weights[2]);
  const auto w3 = hn::Set(d, weights[3]);
  for (int j = 0; j < count; j += static_cast<int>(hn::Lanes(d))) {
    const auto upper = hn::MulAdd(w1, hn::Load(d, rows[1] + j), w0 * hn::Load(d, rows[0] + j));
    const auto lower = hn::MulAdd(w3, hn::Load(d, rows[3] + j), w2 * hn::Load(d, rows[2] + j));
    hn::Store(hn::NearestInt(upper + lower), Ints(), places + j);
  }
}

template <int kPixels, int kStep, bool kThird>
HWY_INLINE void describe_all(const SourceBounds& b, LaneRow& row) {
  const Ints d;
  const auto zero = hn::Zero(d);
  auto most_bent = zero;
  for (int j = 0; j < row.count; j += static_cast<int>(hn::Lanes(d))) {
    const Axis x = describe<kPixels, kThird>(row.x + j);
    const Axis y = describe<kPixels, kThird>(row.y + j);
    // All lanes of a vector read as many rows as the one that needs most.
    const auto rows = group_maximum(hn::Max(y.last - y.first + hn::Set(d, 1), hn::Set(d, 2)));
    const auto begin = x.first * hn::Set(d, kStep);
    // Any of these is negative where the lane cannot be taken quickly.
    auto spare = hn::Min(hn::Min(x.first, y.first), hn::Set(d, 0x7FFF) - hn::Max(x.steep, y.steep));
    spare = hn::Min(spare,
                    hn::Min(hn::Set(d, b.last_column) - x.last, hn::Set(d, b.last_row) - y.last));
    spare = hn::Min(
        spare, hn::Min(hn::Set(d, b.widest) - (x.last - x.first), hn::Set(d, kMostRows) - rows));
    const auto left = hn::Set(d, b.rows) - y.first - rows;
    spare = hn::Min(spare, left);
    // Segments may end behind a row, but for the last one.
    spare = hn::Min(spare,
                    hn::Max(left - hn::Set(d, b.guarded_rows), hn::Set(d, b.last_segment) - begin));
    const auto slow = hn::IfThenElse(spare < zero, hn::Set(d, kSlowLane), zero);
    hn::Store(hn::Max(group_maximum(slow), rows), d, row.rows + j);
    hn::Store(y.first * hn::Set(d, b.stride) + begin, d, row.offset + j);
    hn::Store(x.line, d, row.x_line + j);
    hn::Store(y.line, d, row.y_line + j);
    hn::Store(hn::Or(hn::And(x.bend, hn::Set(d, 0xFFFF)), hn::ShiftLeft<16>(y.bend)), d,
              row.bend + j);
    most_bent = hn::Max(most_bent, hn::Max(hn::Abs(x.bend), hn::Abs(y.bend)));
  }
  row.bent = hn::GetLane(hn::MaxOfLanes(d, most_bent)) > kStraight;
}

void interpolate_row(const NodeRows& nodes, const float* weights, int count, LaneRow& row) {
  row.count = count;
  interpolate(nodes.x, weights, count + 2 * kMargin + kSpare, row.x);
  interpolate(nodes.y, weights, count + 2 * kMargin + kSpare, row.y);
}

template <int kPixels, int kStep>
void describe_steps(const SourceBounds& bounds, LaneRow& row) {
  bounds.strongly_bent ? describe_all<kPixels, kStep, true>(bounds, row)
                       : describe_all<kPixels, kStep, false>(bounds, row);
}

void describe_row(LaneLayout layout, const SourceBounds& bounds, LaneRow& row) {
  switch (layout) {
    case LaneLayout::kOne:
      return describe_steps<8, 1>(bounds, row);
    case LaneLayout::kOneWord:
      return describe_steps<8, 2>(bounds, row);
    case LaneLayout::kTwoWords:
      return describe_steps<8, 4>(bounds, row);
    case LaneLayout::kTwo:
      return describe_steps<4, 2>(bounds, row);
    case LaneLayout::kThree:
      return describe_steps<2, 3>(bounds, row);
    case LaneLayout::kFour:
      return describe_steps<2, 4>(bounds, row);
    case LaneLayout::kOneSpread:
      return describe_steps<8, 2>(bounds, row);
    case LaneLayout::kTwoSpread:
      return describe_steps<4, 4>(bounds, row);
    case LaneLayout::kNone:
      std::fill_n(row.rows, row.count, kSlowLane);
  }
}

int group() { return kLanes; }

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(interpolate_row);
HWY_EXPORT(describe_row);
HWY_EXPORT(group);

void interpolate_lanes(const NodeRows& nodes, const float* weights, int count,
                       LaneRow& row) noexcept {
  HWY_DYNAMIC_DISPATCH(interpolate_row)(nodes, weights, count, row);
}

void describe_lanes(LaneLayout layout, const SourceBounds& bounds, LaneRow& row) noexcept {
  HWY_DYNAMIC_DISPATCH(describe_row)(layout, bounds, row);
}

int lane_group() noexcept { return HWY_DYNAMIC_DISPATCH(group)(); }

}  // namespace calvin::remap
#endif
