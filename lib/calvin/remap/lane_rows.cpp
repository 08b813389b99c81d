// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Preparation of a row of lanes: where each lies in the source, for every instruction set.

#include "calvin/remap/lane_targets.hpp"
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

void interpolate_row(const NodeRows& nodes, const float* weights, int runs, std::int32_t* xs,
                     std::int32_t* ys) {
  for (int j = 0; j < runs + 2 * kMargin + kSpare; ++j) {
    float x = 0;
    float y = 0;
    for (int r = 0; r < 4; ++r) {
      x += weights[r] * nodes.x[r][j];
      y += weights[r] * nodes.y[r][j];
    }
    xs[j] = static_cast<std::int32_t>(std::lrint(x));
    ys[j] = static_cast<std::int32_t>(std::lrint(y));
  }
}

void begin_band_of(LaneLayout /*layout*/, int /*run*/, const SourceBounds& /*bounds*/,
                   LaneBand& /*band*/, LaneRow& /*row*/) {}

void describe_row(LaneLayout /*layout*/, int /*run*/, const SourceBounds& /*bounds*/,
                  const LaneBand& /*band*/, LaneRow& row) {
  std::fill_n(row.rows, row.count, kSlowLane);
}

int group() { return 1; }

#else

// ---- Preparation: vectors of 32-bit numbers, one per lane.

// Places of 4.12 reach over 16 rows.
constexpr std::int32_t kMostRows = 15;

constexpr std::int32_t kHalfRow = 1 << (kPlaceBits - 1);

// What a parabola through the middles of runs is made of, one per run.
struct Curve {
  hn::Vec<Ints> middle;
  hn::Vec<Ints> across;  // from the run before to the one behind
  hn::Vec<Ints> second;  // difference
};

// `places` of two runs before, of the run, and of two behind.
template <bool kThird>
HWY_INLINE Curve curve_at(const std::int32_t* places) {
  const Ints d;
  const auto before = hn::LoadU(d, places + 1);
  const auto middle = hn::LoadU(d, places + 2);
  const auto after = hn::LoadU(d, places + 3);
  auto across = after - before;
  if constexpr (kThird) {
    const auto third = hn::LoadU(d, places + 4) - hn::Load(d, places) - across - across;
    across = across - hn::ShiftRight<8>(third * hn::Set(d, kThirdPart));
  }
  return {middle, across, before + after - middle - middle};
}

// What a lane needs of an axis, in the units of LaneRow.
struct Line {
  hn::Vec<Ints> middle;
  hn::Vec<Ints> slope;  // 2.14
  hn::Vec<Ints> bend;   // 4.12
};

// The lane is the run.
template <int kPixels>
HWY_INLINE Line line_of(const Curve& curve) {
  // Second difference -> what the parabola adds at the ends, and half of the width for the slope.
  constexpr int kFactor = kPixels == 8 ? 49 : 9;
  constexpr int kShift = kPixels == 8 ? 11 : 9;
  constexpr int kSlopeShift = kPixels == 8 ? 4 : kPixels == 4 ? 3 : 2;
  const auto slope = hn::ShiftRight<kSlopeShift>(curve.across);
  // Two samples lie on a line, beside the parabola's middle.
  if constexpr (kPixels == 2) {
    return {curve.middle + hn::ShiftRight<5>(curve.second), slope, hn::Zero(Ints())};
  }
  return {curve.middle, slope, hn::ShiftRight<kShift>(curve.second * hn::Set(Ints(), kFactor))};
}

// The lane that lies `halves` half samples behind the middle of its run of eight, when a run is
// two lanes (at -4 and 4) or four (at -6, -2, 2 and 6).
template <int kPixels, int kHalves>
HWY_INLINE Line part_of(const Curve& curve) {
  static_assert(kPixels == 4 || kPixels == 2);
  const Ints d;
  // With t in samples: middle + t across / 16 + t^2 second / 128.
  const auto along = hn::ShiftRight<5>(curve.across * hn::Set(d, kHalves));
  // Two samples lie on a line, beside the parabola's middle.
  constexpr int kSquare = kHalves * kHalves + (kPixels == 2 ? 1 : 0);
  const auto square = hn::ShiftRight<9>(curve.second * hn::Set(d, kSquare));
  const auto slope =
      hn::ShiftRight<4>(curve.across) + hn::ShiftRight<7>(curve.second * hn::Set(d, kHalves));
  // 1.5^2 / 128, 4.12.
  const auto bend = kPixels == 4 ? hn::ShiftRight<11>(curve.second * hn::Set(d, 9)) : hn::Zero(d);
  return {curve.middle + along + square, slope, bend};
}

struct Axis {
  hn::Vec<Ints> first;  // sample
  hn::Vec<Ints> last;   // the last place's; its neighbour is the next one
  hn::Vec<Ints> line;   // as in LaneRow
  hn::Vec<Ints> bend;   // 4.12
  hn::Vec<Ints> steep;  // size of the slope, 2.14
};

// What the places of a lane are away from its middle at most, and a little.
template <int kPixels>
HWY_INLINE hn::Vec<Ints> half_of(const Line& line) {
  const auto steep = hn::Abs(line.slope);
  // (kPixels - 1) / 2 slopes from the middle to the ends.
  auto half = hn::ShiftRight<1>(steep) + hn::Set(Ints(), 16);
  if constexpr (kPixels == 4) half = half + steep;
  if constexpr (kPixels == 8) half = half + hn::ShiftLeft<1>(steep) + steep;
  if constexpr (kPixels > 2) half = half + hn::ShiftLeft<2>(hn::Abs(line.bend));
  return half;
}

template <int kPixels>
HWY_INLINE Axis describe(const Line& line) {
  const Ints d;
  const hn::Repartition<std::int16_t, Ints> halves;
  Axis axis;
  axis.steep = hn::Abs(line.slope);
  const auto half = half_of<kPixels>(line);
  axis.first = hn::ShiftRight<kPlaceBits>(line.middle - half);
  axis.last = hn::ShiftRight<kPlaceBits>(line.middle + half);
  auto centre = line.middle + hn::Set(d, 2) - hn::ShiftLeft<kPlaceBits>(axis.first);
  if constexpr (kPixels > 2) centre = centre + hn::ShiftLeft<1>(line.bend);
  axis.line = hn::BitCast(d, hn::OddEven(hn::BitCast(halves, hn::ShiftLeft<16>(line.slope)),
                                         hn::BitCast(halves, hn::ShiftRight<2>(centre))));
  axis.bend = line.bend;
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

// A vector of lanes whose first one is `j`.
template <int kPixels, int kStep>
HWY_INLINE void describe_lanes_at(int j, const Line& x_line, const Line& y_line,
                                  const SourceBounds& b, LaneRow& row) {
  const Ints d;
  const hn::Repartition<std::int16_t, Ints> halves;
  const Axis x = describe<kPixels>(x_line);
  const Axis y = describe<kPixels>(y_line);
  // All lanes of a vector read as many rows as the one that needs most.
  auto rows = y.last - y.first + hn::Set(d, 2);
  // Three rows, of which a result needs two, go quickest.
  rows = hn::Max(rows, hn::Min(hn::Set(d, 3), hn::Set(d, b.rows) - y.first));
  rows = group_maximum(rows);
  const auto begin = x.first * hn::Set(d, kStep);
  // Any of these is negative where the lane cannot be taken quickly.
  auto spare = hn::Min(hn::Min(x.first, y.first), hn::Set(d, 0x7FFF) - hn::Max(x.steep, y.steep));
  spare = hn::Min(
      spare, hn::Min(hn::Set(d, b.last_column - 1) - x.last, hn::Set(d, b.last_row - 1) - y.last));
  spare = hn::Min(
      spare, hn::Min(hn::Set(d, b.widest - 1) - (x.last - x.first), hn::Set(d, kMostRows) - rows));
  const auto left = hn::Set(d, b.rows) - y.first - rows;
  // Segments may end behind a row, but for the last one.
  spare = hn::Min(hn::Min(spare, left),
                  hn::Max(left - hn::Set(d, b.guarded_rows), hn::Set(d, b.last_segment) - begin));
  const auto slow = hn::And(hn::BroadcastSignBit(spare), hn::Set(d, kSlowLane));
  hn::Store(hn::Max(group_maximum(slow), rows), d, row.rows + j);
  hn::Store(y.first * hn::Set(d, b.stride) + begin, d, row.offset + j);
  hn::Store(x.line, d, row.x_line + j);
  hn::Store(y.line, d, row.y_line + j);
  if constexpr (kPixels > 2) {
    const auto bend =
        hn::OddEven(hn::BitCast(halves, hn::ShiftLeft<16>(y.bend)), hn::BitCast(halves, x.bend));
    hn::Store(hn::BitCast(d, bend), d, row.bend + j);
  }
}

// The parts of a vector of runs one behind the other, in the order of the picture.
template <class V>
HWY_INLINE void interleave(const std::array<V, 2>& parts, std::int32_t* to) {
  hn::StoreInterleaved2(parts[0], parts[1], Ints(), to);
}
template <class V>
HWY_INLINE void interleave(const std::array<V, 4>& parts, std::int32_t* to) {
  hn::StoreInterleaved4(parts[0], parts[1], parts[2], parts[3], Ints(), to);
}

// One axis of a vector of runs, taken apart.
template <int kParts>
struct Parts {
  static constexpr int kCount = kParts * static_cast<int>(hn::MaxLanes(Ints()));
  alignas(64) std::int32_t middle[kCount];
  alignas(64) std::int32_t slope[kCount];
  alignas(64) std::int32_t bend[kCount];

  HWY_INLINE void fill(const Curve& curve) {
    std::array<Line, kParts> lines;
    if constexpr (kParts == 2) {
      lines = {part_of<4, -4>(curve), part_of<4, 4>(curve)};
    } else {
      lines = {part_of<2, -6>(curve), part_of<2, -2>(curve), part_of<2, 2>(curve),
               part_of<2, 6>(curve)};
    }
    std::array<hn::Vec<Ints>, kParts> values;
    const auto store = [&](auto member, std::int32_t* to) HWY_ATTR {
      for (std::size_t i = 0; i < kParts; ++i) values[i] = lines[i].*member;
      interleave(values, to);
    };
    store(&Line::middle, middle);
    store(&Line::slope, slope);
    if constexpr (kParts == 2) store(&Line::bend, bend);
  }
  [[nodiscard]] HWY_INLINE Line at(int j) const {
    const Ints d;
    return {hn::Load(d, middle + j), hn::Load(d, slope + j),
            kParts == 2 ? hn::Load(d, bend + j) : hn::Zero(d)};
  }
};

// ---- Bands of rows.

// One axis of a vector of lanes that are runs, in the first and in the last row of a band.
struct BandAxis {
  hn::Vec<Ints> half;
  hn::Vec<Ints> bend;
  hn::Vec<Ints> least;  // place
  hn::Vec<Ints> most;
  hn::Vec<Ints> steep;
};
HWY_INLINE BandAxis band_axis(const std::int32_t* first, const std::int32_t* last) {
  const Ints d;
  // What lies between the two rows may be beyond both of them by as much.
  const auto slack = hn::Set(d, 1 << kPlaceBits);
  const Line a = line_of<8>(curve_at<false>(first));
  const Line b = line_of<8>(curve_at<false>(last));
  const auto half = hn::Max(half_of<8>(a), half_of<8>(b)) + hn::Set(d, 64);
  return {half, hn::ShiftRight<1>(a.bend + b.bend), hn::Min(a.middle, b.middle) - half - slack,
          hn::Max(a.middle, b.middle) + half + slack, hn::Max(hn::Abs(a.slope), hn::Abs(b.slope))};
}

// Whether none of a vector of lanes needs to be looked at again in the band: three rows, and far
// from the ends of the source.
HWY_INLINE bool is_steady(const BandAxis& x, const BandAxis& y, const SourceBounds& b) {
  const Ints d;
  const auto last = [&](const BandAxis& axis)
                        HWY_ATTR { return hn::ShiftRight<kPlaceBits>(axis.most); };
  const auto last_row =
      hn::Min(hn::Set(d, b.last_row - 1), hn::Set(d, b.rows - b.guarded_rows - 2));
  auto spare = hn::Min(hn::Min(x.least, y.least), hn::Set(d, 0x7000) - hn::Max(x.steep, y.steep));
  spare = hn::Min(spare, hn::Min(hn::Set(d, b.last_column - 1) - last(x), last_row - last(y)));
  spare =
      hn::Min(spare, hn::Min(hn::Set(d, kHalfRow) - y.half,
                             hn::Set(d, b.widest - 2) - hn::ShiftRight<kPlaceBits - 1>(x.half)));
  return hn::AllFalse(d, hn::Lt(spare, hn::Zero(d)));
}

void begin_band_of(LaneLayout layout, int run, const SourceBounds& bounds, LaneBand& band,
                   LaneRow& row) {
  const Ints d;
  const hn::Repartition<std::int16_t, Ints> halves;
  constexpr int kVector = static_cast<int>(hn::MaxLanes(Ints()));
  const bool whole = run == 8 && lane_pixels(layout) == 8 && !bounds.strongly_bent;
  for (int j = 0; j < row.count; j += kVector) {
    band.steady[j] = false;
    if (!whole) continue;
    const BandAxis x = band_axis(row.x + j, band.x_last + j);
    const BandAxis y = band_axis(row.y + j, band.y_last + j);
    if (!is_steady(x, y, bounds)) continue;
    band.steady[j] = true;
    // Results lie between the row that is nearest to the middle and the ones beside it.
    const auto y_half = hn::Set(d, kHalfRow);
    hn::Store(x.half, d, band.x_half + j);
    hn::Store(y_half, d, band.y_half + j);
    hn::Store(x.half + hn::Set(d, 2) + hn::ShiftLeft<1>(x.bend), d, band.x_shift + j);
    hn::Store(y_half + hn::Set(d, 2) + hn::ShiftLeft<1>(y.bend), d, band.y_shift + j);
    hn::Store(hn::Set(d, 3), d, row.rows + j);
    const auto bend =
        hn::OddEven(hn::BitCast(halves, hn::ShiftLeft<16>(y.bend)), hn::BitCast(halves, x.bend));
    hn::Store(hn::BitCast(d, bend), d, row.bend + j);
  }
}

struct SteadyAxis {
  hn::Vec<Ints> first;
  hn::Vec<Ints> line;
};
HWY_INLINE SteadyAxis steady_axis(const std::int32_t* places, const std::int32_t* half,
                                  const std::int32_t* shift) {
  const Ints d;
  const hn::Repartition<std::int16_t, Ints> halves;
  const auto across = hn::LoadU(d, places + 3) - hn::LoadU(d, places + 1);
  const auto low = hn::LoadU(d, places + 2) - hn::Load(d, half);
  const auto rest = hn::And(low, hn::Set(d, (1 << kPlaceBits) - 1)) + hn::Load(d, shift);
  return {hn::ShiftRight<kPlaceBits>(low),
          hn::BitCast(d, hn::OddEven(hn::BitCast(halves, hn::ShiftLeft<12>(across)),
                                     hn::BitCast(halves, hn::ShiftRight<2>(rest))))};
}

// describe_lanes_at() where the band is steady.
template <int kStep>
HWY_INLINE void describe_steady_at(int j, const SourceBounds& b, const LaneBand& band,
                                   LaneRow& row) {
  const Ints d;
  const SteadyAxis x = steady_axis(row.x + j, band.x_half + j, band.x_shift + j);
  const SteadyAxis y = steady_axis(row.y + j, band.y_half + j, band.y_shift + j);
  hn::Store(y.first * hn::Set(d, b.stride) + x.first * hn::Set(d, kStep), d, row.offset + j);
  hn::Store(x.line, d, row.x_line + j);
  hn::Store(y.line, d, row.y_line + j);
}

template <int kRun, int kPixels, int kStep, bool kThird>
HWY_INLINE void describe_all(const SourceBounds& bounds, const LaneBand& band, LaneRow& row) {
  constexpr int kVector = static_cast<int>(hn::MaxLanes(Ints()));
  constexpr int kParts = kRun / kPixels;
  for (int run = 0; run * kParts < row.count; run += kVector) {
    if constexpr (kPixels == 8) {
      if (band.steady[run]) {
        describe_steady_at<kStep>(run, bounds, band, row);
        continue;
      }
    }
    const Curve x = curve_at<kThird>(row.x + run);
    const Curve y = curve_at<kThird>(row.y + run);
    if constexpr (kParts == 1) {
      describe_lanes_at<kPixels, kStep>(run, line_of<kPixels>(x), line_of<kPixels>(y), bounds, row);
    } else {
      Parts<kParts> x_parts;
      Parts<kParts> y_parts;
      x_parts.fill(x);
      y_parts.fill(y);
      for (int j = 0; j < kParts * kVector; j += kVector) {
        describe_lanes_at<kPixels, kStep>(run * kParts + j, x_parts.at(j), y_parts.at(j), bounds,
                                          row);
      }
    }
  }
}

void interpolate_row(const NodeRows& nodes, const float* weights, int runs, std::int32_t* x,
                     std::int32_t* y) {
  interpolate(nodes.x, weights, runs + 2 * kMargin + kSpare, x);
  interpolate(nodes.y, weights, runs + 2 * kMargin + kSpare, y);
}

template <int kRun, int kPixels, int kStep>
void describe_bends(const SourceBounds& bounds, const LaneBand& band, LaneRow& row) {
  bounds.strongly_bent ? describe_all<kRun, kPixels, kStep, true>(bounds, band, row)
                       : describe_all<kRun, kPixels, kStep, false>(bounds, band, row);
}

template <int kPixels, int kStep>
void describe_steps(int run, const SourceBounds& bounds, const LaneBand& band, LaneRow& row) {
  run == kPixels ? describe_bends<kPixels, kPixels, kStep>(bounds, band, row)
                 : describe_bends<8, kPixels, kStep>(bounds, band, row);
}

void describe_row(LaneLayout layout, int run, const SourceBounds& bounds, const LaneBand& band,
                  LaneRow& row) {
  switch (layout) {
    case LaneLayout::kOne:
      return describe_bends<8, 8, 1>(bounds, band, row);
    case LaneLayout::kOneSpread:
    case LaneLayout::kOneWord:
      return describe_bends<8, 8, 2>(bounds, band, row);
    case LaneLayout::kTwoWords:
      return describe_bends<8, 8, 4>(bounds, band, row);
    case LaneLayout::kTwo:
      return describe_steps<4, 2>(run, bounds, band, row);
    case LaneLayout::kTwoSpread:
      return describe_steps<4, 4>(run, bounds, band, row);
    case LaneLayout::kThree:
      return describe_steps<2, 3>(run, bounds, band, row);
    case LaneLayout::kFour:
      return describe_steps<2, 4>(run, bounds, band, row);
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
HWY_EXPORT(begin_band_of);
HWY_EXPORT(describe_row);
HWY_EXPORT(group);

void interpolate_runs(const NodeRows& nodes, const float* weights, int runs, std::int32_t* x,
                      std::int32_t* y) noexcept {
  HWY_DYNAMIC_DISPATCH(interpolate_row)(nodes, weights, runs, x, y);
}

void begin_band(LaneLayout layout, int run, const SourceBounds& bounds, LaneBand& band,
                LaneRow& row) noexcept {
  HWY_DYNAMIC_DISPATCH(begin_band_of)(layout, run, bounds, band, row);
}

void describe_lanes(LaneLayout layout, int run, const SourceBounds& bounds, const LaneBand& band,
                    LaneRow& row) noexcept {
  HWY_DYNAMIC_DISPATCH(describe_row)(layout, run, bounds, band, row);
}

int lane_group() noexcept { return HWY_DYNAMIC_DISPATCH(group)(); }

}  // namespace calvin::remap
#endif
