// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Preparation of a row of runs: where each lies in the source, for every instruction set.

// As lane_blend.cpp.
#define HWY_WANT_AVX3_DL 1

#include "calvin/remap/lane_targets.hpp"
#include "calvin/remap/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/lane_rows.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/lane_curves-inl.hpp"

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

bool describe_row(LaneLayout /*layout*/, int /*run*/, const SourceBounds& /*bounds*/,
                  const Band& /*band*/, RunRow& row) {
  std::fill_n(row.rows, row.count, kSlowRun | kSlowGroup);
  return true;
}

int group() { return 1; }

#else

// ---- Vectors of 32-bit numbers, one per run.

// Places of 4.12 reach over 16 rows.
constexpr std::int32_t kMostRows = 15;

// A slope down whose eightfold still is 2.14.
constexpr std::int32_t kSteepest = 0x0F00;

struct Axis {
  hn::Vec<Ints> first;  // sample
  hn::Vec<Ints> last;   // the last place's; its neighbour is the next one
  hn::Vec<Ints> place;  // of the middle from the first sample, and half of the bend
  hn::Vec<Ints> steep;  // size of the slope, 2.14
  hn::Vec<Ints> bend;   // 4.12
};
template <int kRun>
HWY_INLINE Axis describe(const Line& line) {
  const auto half = half_of<kRun>(line);
  const auto first = hn::ShiftRight<kPlaceBits>(line.middle - half);
  auto place = line.middle - hn::ShiftLeft<kPlaceBits>(first);
  if constexpr (kRun > 2) place = place + hn::ShiftLeft<1>(line.bend);
  return {first, hn::ShiftRight<kPlaceBits>(line.middle + half), place, hn::Abs(line.slope),
          line.bend};
}

// The largest of the runs that make a group, in each of them.
HWY_INLINE hn::Vec<Ints> group_maximum(hn::Vec<Ints> rows) {
  if constexpr (kLanes >= 2) rows = hn::Max(rows, hn::Shuffle2301(rows));
  if constexpr (kLanes >= 4) rows = hn::Max(rows, hn::Shuffle1032(rows));
  return rows;
}

HWY_INLINE void interpolate(const float (&rows)[4][NodeRows::kRuns], const float* weights,
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

// What a vector of runs reads of the source.
struct Reads {
  hn::Vec<Ints> rows;    // the same for all runs of a group
  hn::Vec<Ints> offset;  // negative where all of the group are slow
  hn::Vec<Ints> slow;    // -1 or 0
};
template <int kStep>
HWY_INLINE Reads reads_of(const Axis& x, const Axis& y, const SourceBounds& b) {
  const Ints d;
  // Three rows, of which a result needs two, go quickest; steep lines do not fit eight times.
  auto rows = y.last - y.first + hn::Set(d, 2);
  rows = hn::Max(rows, hn::Min(hn::Set(d, 3), hn::Set(d, b.rows) - y.first));
  const auto too_steep = hn::BroadcastSignBit(hn::Set(d, kSteepest) - y.steep);
  rows = hn::Max(rows, hn::And(too_steep, hn::Set(d, 4)));
  // Any of these is negative where the run cannot be taken quickly.
  const auto x_room = hn::Set(d, b.steepest) - x.steep - hn::ShiftLeft<3>(hn::Abs(x.bend));
  auto spare = hn::Min(hn::Min(x.first, y.first), hn::Min(x_room, hn::Set(d, 0x7FFF) - y.steep));
  spare = hn::Min(
      spare, hn::Min(hn::Set(d, b.last_column - 1) - x.last, hn::Set(d, b.last_row - 1) - y.last));
  spare = hn::Min(
      spare, hn::Min(hn::Set(d, b.widest - 1) - (x.last - x.first), hn::Set(d, kMostRows) - rows));
  // All runs of a group read as many rows as the one that needs most.
  rows = group_maximum(hn::AndNot(hn::BroadcastSignBit(spare), rows));
  const auto begin = x.first * hn::Set(d, kStep);
  const auto left = hn::Set(d, b.rows) - y.first - rows;
  // Segments may end behind a row, but for the last one.
  spare = hn::Min(hn::Min(spare, left),
                  hn::Max(left - hn::Set(d, b.guarded_rows), hn::Set(d, b.last_segment) - begin));
  const auto slow = hn::BroadcastSignBit(spare);
  // The slow ones of a group that has others read what one of these does.
  const auto is_slow = hn::MaskFromVec(slow);
  const auto own = hn::IfThenElse(is_slow, slow, y.first * hn::Set(d, b.stride) + begin);
  return {rows, hn::IfThenElse(is_slow, group_maximum(own), own), slow};
}

// A vector of runs whose first one is `j`; whether one is slow.
template <int kRun, int kStep>
HWY_INLINE bool describe_runs_at(int j, const Line& x_line, const Line& y_line,
                                 const SourceBounds& b, RunRow& row) {
  const Ints d;
  const Axis x = describe<kRun>(x_line);
  const Axis y = describe<kRun>(y_line);
  const Reads reads = reads_of<kStep>(x, y, b);
  const auto is_slow = hn::MaskFromVec(reads.slow);
  const auto marks = hn::Or(hn::And(reads.slow, hn::Set(d, kSlowRun)),
                            hn::And(hn::BroadcastSignBit(reads.offset), hn::Set(d, kSlowGroup)));
  hn::Store(hn::Or(reads.rows, marks), d, row.rows + j);
  hn::Store(reads.offset, d, row.offset + j);
  const auto place = [&](const Axis& axis)
                         HWY_ATTR { return hn::ShiftRight<2>(axis.place + hn::Set(d, 2)); };
  const auto line = packed(place(x), hn::ShiftLeft<16>(x_line.slope));
  // The slow ones read the middle of the first column.
  hn::Store(hn::IfThenElse(is_slow, hn::Set(d, 1 << 11), line), d, row.x_line + j);
  const auto three = reads.rows == hn::Set(d, 3);
  const auto centred = hn::ShiftLeft<1>(y.place - hn::Set(d, 1 << kPlaceBits));
  const auto high = [&](hn::Vec<Ints> number) HWY_ATTR {
    return hn::IfThenElse(three, hn::ShiftLeft<19>(number), hn::ShiftLeft<16>(number));
  };
  hn::Store(packed(hn::IfThenElse(three, centred, place(y)), high(y_line.slope)), d,
            row.y_line + j);
  if constexpr (kRun > 2) {
    hn::Store(hn::IfThenZeroElse(is_slow, packed(x_line.bend, high(y_line.bend))), d, row.bend + j);
  }
  return !hn::AllTrue(d, reads.slow == hn::Zero(d));
}

// describe_runs_at() where the band is steady: results lie between the row that is nearest to the
// run's middle and the ones beside it.
template <int kStep, bool kThird>
HWY_INLINE void describe_steady_at(int j, const SourceBounds& b, const Band& band, RunRow& row) {
  const Ints d;
  const auto part = hn::Set(d, (1 << kPlaceBits) - 1);
  const auto across = [&](const std::int32_t* places)
                          HWY_ATTR { return curve_at<kThird>(places).across; };
  const auto x = hn::LoadU(d, row.x + j + kMargin) - hn::Load(d, band.x_half + j);
  const auto y = hn::LoadU(d, row.y + j + kMargin) - hn::Set(d, kHalfRow);
  hn::Store(hn::ShiftRight<kPlaceBits>(y) * hn::Set(d, b.stride) +
                hn::ShiftRight<kPlaceBits>(x) * hn::Set(d, kStep),
            d, row.offset + j);
  const auto x_place = hn::ShiftRight<2>(hn::And(x, part) + hn::Load(d, band.x_shift + j));
  const auto y_place = hn::ShiftLeft<1>(hn::And(y, part) + hn::Load(d, band.y_shift + j));
  hn::Store(packed(x_place, hn::ShiftLeft<12>(across(row.x + j))), d, row.x_line + j);
  hn::Store(packed(y_place, hn::ShiftLeft<15>(across(row.y + j))), d, row.y_line + j);
}

// ---- Lanes of runs of eight.

// The parts of a vector of runs one behind the other, in the order of the picture.
template <class V>
HWY_INLINE void interleave(const std::array<V, 2>& parts, std::int32_t* to) {
  hn::StoreInterleaved2(parts[0], parts[1], Ints(), to);
}
template <class V>
HWY_INLINE void interleave(const std::array<V, 4>& parts, std::int32_t* to) {
  hn::StoreInterleaved4(parts[0], parts[1], parts[2], parts[3], Ints(), to);
}

// The place of the sample that lies `kHalves` halves behind the middle, 4.12, from what RunRow
// says.
template <int kHalves>
HWY_INLINE hn::Vec<Ints> place_at(hn::Vec<Ints> place, hn::Vec<Ints> slope, hn::Vec<Ints> bend) {
  constexpr int kSquare = 4096 * (2 * kHalves * kHalves - 49) / 98;
  return place + hn::ShiftRight<3>(slope * hn::Set(Ints(), kHalves)) +
         hn::ShiftRight<12>(bend * hn::Set(Ints(), kSquare));
}

// A lane's segment begins with the first column that one of its samples needs.
template <int kParts, int kStep, std::size_t... kPart>
HWY_INLINE void split_runs_at(int j, RunRow& row, std::index_sequence<kPart...> /*parts*/) {
  const Ints d;
  constexpr int kLane = 8 / kParts;
  // Rounding, and what the parabola is bent between a lane's ends.
  const auto slack = hn::Set(d, kLane > 2 ? 64 : 8);
  const auto line = hn::Load(d, row.x_line + j);
  const auto place = hn::And(line, hn::Set(d, 0xFFFF));
  const auto slope = hn::ShiftRight<16>(line);
  const auto bend = hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::Load(d, row.bend + j)));
  const auto before = [&](auto part) HWY_ATTR {
    constexpr int kFirst = 2 * kLane * decltype(part)::value - reach(8);
    constexpr int kLast = kFirst + 2 * (kLane - 1);
    return hn::ShiftRight<12>(
        hn::Min(place_at<kFirst>(place, slope, bend), place_at<kLast>(place, slope, bend)) - slack);
  };
  const std::array<hn::Vec<Ints>, kParts> columns = {
      before(std::integral_constant<int, kPart>())...};
  const auto offset = hn::Load(d, row.offset + j);
  interleave(std::array{offset + columns[kPart] * hn::Set(d, kStep)...},
             row.lane_offset + kParts * j);
  interleave(std::array{packed(place - hn::ShiftLeft<12>(columns[kPart]), line)...},
             row.lane_line + kParts * j);
}

template <int kRun, int kParts, int kStep, bool kThird>
HWY_INLINE bool describe_all(const SourceBounds& bounds, const Band& band, RunRow& row) {
  constexpr int kVector = static_cast<int>(hn::MaxLanes(Ints()));
  bool slow = false;
  for (int j = 0; j < row.count; j += kVector) {
    if (kRun == 8 && band.steady[j]) {
      describe_steady_at<kStep, kThird>(j, bounds, band, row);
    } else {
      const Line x = line_of<kRun>(curve_at<kThird>(row.x + j));
      const Line y = line_of<kRun>(curve_at<kThird>(row.y + j));
      slow |= describe_runs_at<kRun, kStep>(j, x, y, bounds, row);
    }
    if constexpr (kParts > 1 && !kMovesAllBytes) {
      split_runs_at<kParts, kStep>(j, row, std::make_index_sequence<kParts>());
    }
  }
  return slow;
}

void interpolate_row(const NodeRows& nodes, const float* weights, int runs, std::int32_t* x,
                     std::int32_t* y) {
  interpolate(nodes.x, weights, runs + 2 * kMargin + kSpare, x);
  interpolate(nodes.y, weights, runs + 2 * kMargin + kSpare, y);
}

template <int kRun, int kParts, int kStep>
bool describe_bends(const SourceBounds& bounds, const Band& band, RunRow& row) {
  return bounds.strongly_bent ? describe_all<kRun, kParts, kStep, true>(bounds, band, row)
                              : describe_all<kRun, kParts, kStep, false>(bounds, band, row);
}

// Runs of 8 samples, or of one lane.
template <int kLane, int kStep>
bool describe_length(int run, const SourceBounds& bounds, const Band& band, RunRow& row) {
  return run == 8 ? describe_bends<8, 8 / kLane, kStep>(bounds, band, row)
                  : describe_bends<kLane, 1, kStep>(bounds, band, row);
}

bool describe_row(LaneLayout layout, int run, const SourceBounds& bounds, const Band& band,
                  RunRow& row) {
  switch (layout) {
    case LaneLayout::kOne:
      return describe_bends<8, 1, 1>(bounds, band, row);
    case LaneLayout::kOneSpread:
    case LaneLayout::kOneWord:
      return describe_bends<8, 1, 2>(bounds, band, row);
    case LaneLayout::kTwoWords:
      return describe_bends<8, 1, 4>(bounds, band, row);
    case LaneLayout::kTwo:
      return describe_length<4, 2>(run, bounds, band, row);
    case LaneLayout::kTwoSpread:
      return describe_length<4, 4>(run, bounds, band, row);
    case LaneLayout::kThree:
      return describe_length<2, 3>(run, bounds, band, row);
    case LaneLayout::kFour:
      return describe_length<2, 4>(run, bounds, band, row);
    default:
      std::fill_n(row.rows, row.count, kSlowRun | kSlowGroup);
      return true;
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

void interpolate_runs(const NodeRows& nodes, const float* weights, int runs, std::int32_t* x,
                      std::int32_t* y) noexcept {
  HWY_DYNAMIC_DISPATCH(interpolate_row)(nodes, weights, runs, x, y);
}

bool describe_runs(LaneLayout layout, int run, const SourceBounds& bounds, const Band& band,
                   RunRow& row) noexcept {
  return HWY_DYNAMIC_DISPATCH(describe_row)(layout, run, bounds, band, row);
}

int run_group() noexcept { return HWY_DYNAMIC_DISPATCH(group)(); }

}  // namespace calvin::remap
#endif
