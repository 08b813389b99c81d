// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Describes a row of runs for the bilinear kernels, for every instruction set: where each run lies
// in the source, how many rows of the source it needs, and which runs the kernels cannot take.

// Ice Lake and Zen 4 permute all bytes of a vector: remap/kernels/bilinear/blend_rows.cpp.
#define HWY_WANT_AVX3_DL 1

#include "calvin/core/vector_targets.hpp"
#include "calvin/remap/kernels/bilinear/bilinear_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/kernels/bilinear/describe_rows.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/kernels/bilinear/parabolas-inl.hpp"
#include "calvin/remap/kernels/common/blend_math-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
// Without vectors every run is slow.

void interpolate_row(const RowBetweenNodes& between, int runs, std::int32_t* xs, std::int32_t* ys) {
  const auto at = [&](const float(&rows)[4][NodeRows::kRuns], int i) {
    float sum = rows[0][i];
    for (int r = 1; r < 4; ++r) sum += between.weights[r] * (rows[r][i] - rows[0][i]);
    return static_cast<std::int32_t>(std::lrint(sum));
  };
  for (int j = 0; j < runs + 2 * kMargin + kSpare; ++j) {
    xs[j] = at(between.nodes.x, NodeRows::kFirst - kMargin + j);
    ys[j] = at(between.nodes.y, NodeRows::kFirst - kMargin + j);
  }
}

int group_of(PixelLayout /*layout*/, int /*run*/) { return 1; }

#else

// ---- Vectors of 32-bit numbers, one per run.

// What a run needs of the source along one axis.
struct Axis {
  hn::Vec<Ints> first;      // sample
  hn::Vec<Ints> last;       // sample before the last coordinate; the one behind it is read, too
  hn::Vec<Ints> coord;      // of the middle from the first sample, 1/2^14 of a sample
  hn::Vec<Ints> abs_slope;  // absolute value of the slope, 2.14
  hn::Vec<Ints> bend;       // 4.12
};
template <int kRun>
HWY_INLINE Axis describe(const AxisParabola& parabola) {
  const auto half = half_of<kRun>(parabola);
  const auto first = hn::ShiftRight<kCoordBits>(parabola.middle - half);
  return {first, hn::ShiftRight<kCoordBits>(parabola.middle + half),
          parabola.middle - hn::ShiftLeft<kCoordBits>(first), hn::Abs(parabola.slope),
          parabola.bend};
}

// The largest number of a group of runs, for each of its runs.
template <int kGroup>
HWY_INLINE hn::Vec<Ints> group_maximum(hn::Vec<Ints> rows) {
  if constexpr (kGroup >= 2) rows = hn::Max(rows, hn::Shuffle2301(rows));
  if constexpr (kGroup >= 4) rows = hn::Max(rows, hn::Shuffle1032(rows));
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (kGroup >= 8) rows = hn::Max(rows, hn::SwapAdjacentBlocks(rows));
#else
  static_assert(kGroup < 8);
#endif
  return rows;
}

// The middles of a vector of runs, from the index `i` of NodeRows on.
HWY_INLINE hn::Vec<Ints> middles_at(const float (&rows)[4][NodeRows::kRuns],
                                    const std::array<float, 4>& weights, int i) {
  const Floats d;
  const auto first = hn::LoadU(d, rows[0] + i);
  const auto part = [&](std::size_t r) HWY_ATTR { return hn::Set(d, weights[r]); };
  const auto difference = [&](std::size_t r) HWY_ATTR { return hn::LoadU(d, rows[r] + i) - first; };
  return hn::NearestInt(hn::MulAdd(part(1), difference(1),
                                   hn::MulAdd(part(2), difference(2), part(3) * difference(3))) +
                        first);
}

// Writes `count` of a row's middles from `begin` on, which counts from the first of the margin.
HWY_INLINE void interpolate(const RowBetweenNodes& between, int begin, int count, std::int32_t* x,
                            std::int32_t* y) {
  const Ints d;
  for (int j = begin; j < begin + count; j += static_cast<int>(hn::MaxLanes(d))) {
    const int i = NodeRows::kFirst - kMargin + j;
    hn::StoreU(middles_at(between.nodes.x, between.weights, i), d, x + j);
    hn::StoreU(middles_at(between.nodes.y, between.weights, i), d, y + j);
  }
}

// The first column of a part of the runs, and the distance of the middle from it: 4.12, in the
// lower half of a record.
struct Part {
  hn::Vec<Ints> column;
  hn::Vec<Ints> coord;
};

// What a vector of runs reads of the source.
struct Reads {
  hn::Vec<Ints> rows;    // the same for all runs of a group
  hn::Vec<Ints> offset;  // bytes; negative where all runs of the group are slow
  hn::Vec<Ints> slow;    // -1 or 0
};
template <class P>
HWY_INLINE Reads reads_of(const Axis& x, const Axis& y, const SourceBounds& b) {
  const Ints d;
  auto rows = y.last - y.first + hn::Set(d, 2);
  if constexpr (!P::kPerPixel) {
    // The kernel for three rows is the quickest, and eight times as large y still fit unless the
    // slope is high.
    rows = hn::Max(rows, hn::Min(hn::Set(d, 3), hn::Set(d, b.rows) - y.first));
    const auto high_slope = hn::BroadcastSignBit(hn::Set(d, kMaxSlopeDown) - y.abs_slope);
    rows = hn::Max(rows, hn::And(high_slope, hn::Set(d, 4)));
  }
  // `spare` becomes negative where one of the bounds is violated: the run is slow.
  const auto x_room = hn::Set(d, b.max_slope) - x.abs_slope - hn::ShiftLeft<3>(hn::Abs(x.bend));
  auto spare =
      hn::Min(hn::Min(x.first - hn::Set(d, b.first_column), y.first - hn::Set(d, b.first_row)),
              hn::Min(x_room, hn::Set(d, 0x7FFF) - y.abs_slope));
  spare = hn::Min(
      spare, hn::Min(hn::Set(d, b.last_column - 1) - x.last, hn::Set(d, b.last_row - 1) - y.last));
  spare = hn::Min(spare, hn::Min(hn::Set(d, b.max_columns - 1) - (x.last - x.first),
                                 hn::Set(d, kMaxSourceRows) - rows));
  // All runs of a group read as many rows as the run that needs most.
  rows = group_maximum<P::kGroup>(hn::AndNot(hn::BroadcastSignBit(spare), rows));
  const auto begin = x.first * hn::Set(d, P::kStep);
  const auto left = hn::Set(d, b.rows) - y.first - rows;
  // A segment may end behind its row, unless that is one of the guarded rows.
  spare = hn::Min(hn::Min(spare, left),
                  hn::Max(left - hn::Set(d, b.guarded_rows), hn::Set(d, b.last_segment) - begin));
  const auto slow = hn::BroadcastSignBit(spare);
  // A slow run reads the segment of another run in its group: the segments must be valid memory.
  const auto is_slow = hn::MaskFromVec(slow);
  const auto own = hn::IfThenElse(is_slow, slow, y.first * hn::Set(d, b.stride) + begin);
  return {rows, hn::IfThenElse(is_slow, group_maximum<P::kGroup>(own), own), slow};
}

// Stores what a RunRow has by part, for the vector of runs from `j` on: where each part's segment
// is, and the distance of the run's middle from there.
template <class P, class X>
HWY_INLINE void store_segments(int j, X x_of, hn::Vec<Ints> y_coord, hn::Vec<Ints> row_offset,
                               RunRow& row) {
  const Ints d;
  std::array<Part, P::kParts> parts;
  for_parts<P>([&](auto which) HWY_ATTR { parts[which] = x_of(which); });
  const auto offset = [&](std::size_t part) HWY_ATTR {
    return row_offset + parts[part].column * hn::Set(d, P::kStep);
  };
  const auto middle = [&](std::size_t part)
                          HWY_ATTR { return in_order<P>(hn::Or(parts[part].coord, y_coord)); };
  store_parts<P>(middle, row.middle + j * P::kParts);
  store_parts<P>(offset, P::kParts == 1 ? row.offset + j : row.part_offset + j * P::kParts);
}

// -1 for runs that lie outside of the source by a sample or more, so that they show nothing but the
// fill; else 0.
HWY_INLINE hn::Vec<Ints> outside(const Axis& x, const Axis& y, const SourceBounds& b) {
  const Ints d;
  if (!b.fills) return hn::Zero(d);
  const auto inside = [&](const Axis& axis, std::int32_t count) HWY_ATTR {
    return hn::Min(axis.last + hn::Set(d, 2), hn::Set(d, count) - axis.first);
  };
  return hn::BroadcastSignBit(hn::Min(inside(x, b.columns), inside(y, b.rows)));
}

// Describes the vector of runs from `j` on; returns whether one of them is slow. The function is
// not inlined because it is the same with and without third differences, and compiling it is most
// of the work for this file.
template <class P>
HWY_NOINLINE bool describe_runs_at(int j, const AxisParabola& x_parabola,
                                   const AxisParabola& y_parabola, const SourceBounds& b,
                                   RunRow& row) {
  const Ints d;
  const Axis x = describe<P::kRun>(x_parabola);
  const Axis y = describe<P::kRun>(y_parabola);
  const Reads reads = reads_of<P>(x, y, b);
  const auto is_slow = hn::MaskFromVec(reads.slow);
  const auto empty = hn::And(reads.slow, outside(x, y, b));
  const auto marks =
      hn::Or(hn::Or(hn::And(reads.slow, hn::Set(d, bit(RunMark::kSlow))),
                    hn::And(empty, hn::Set(d, bit(RunMark::kEmpty)))),
             hn::And(hn::BroadcastSignBit(reads.offset), hn::Set(d, bit(RunMark::kSlowGroup))));
  hn::Store(hn::Or(reads.rows, marks), d, row.marks + j);
  hn::Store(reads.offset, d, row.offset + j);
  const auto to_4_12 = [&](hn::Vec<Ints> from_first)
                           HWY_ATTR { return hn::ShiftRight<2>(from_first + hn::Set(d, 2)); };
  auto y_coord = hn::ShiftLeft<16>(to_4_12(y.coord));
  auto y_slope = hn::ShiftLeft<16>(y_parabola.slope);
  auto y_bend = hn::ShiftLeft<16>(y_parabola.bend);
  if constexpr (!P::kPerPixel) {
    const auto three = reads.rows == hn::Set(d, 3);
    const auto centred = hn::ShiftLeft<17>(y.coord - hn::Set(d, 1 << kCoordBits));
    y_coord = hn::IfThenElse(three, centred, y_coord);
    y_slope = hn::IfThenElse(three, hn::ShiftLeft<3>(y_slope), y_slope);
    y_bend = hn::IfThenElse(three, hn::ShiftLeft<3>(y_bend), y_bend);
  }
  // Slow runs in a group with others get records that stay within the segment: no slope, and the
  // middle of its first column.
  const auto record = [&](hn::Vec<Ints> of_x, hn::Vec<Ints> of_y) HWY_ATTR {
    return in_order<P>(hn::IfThenZeroElse(is_slow, packed(of_x, of_y)));
  };
  hn::Store(record(x_parabola.slope, y_slope), d, row.slope + j);
  hn::Store(record(x_parabola.bend, y_bend), d, row.bend + j);
  const auto x_of = [&](auto part) HWY_ATTR {
    const auto half = part_half<P, decltype(part)::value>(x_parabola);
    const auto column =
        hn::IfThenZeroElse(is_slow, hn::ShiftRight<kCoordBits>(x_parabola.middle - half) - x.first);
    const auto from_column = to_4_12(x.coord - hn::ShiftLeft<kCoordBits>(column));
    return Part{column, hn::IfThenElse(is_slow, hn::Set(d, 1 << 11),
                                       hn::And(from_column, hn::Set(d, 0xFFFF)))};
  };
  store_segments<P>(j, x_of, hn::IfThenZeroElse(is_slow, y_coord), reads.offset, row);
  return !hn::AllTrue(d, reads.slow == hn::Zero(d));
}

// What the steady runs of a row share: the weights of Band::SegmentPath at the row.
struct SteadyRow {
  SteadyRow(float part, std::int32_t stride_bytes) {
    const Floats d;
    const float product = part * (1 - part);
    band_fraction = in_register(hn::Set(d, part));
    bow = in_register(hn::Set(d, product));
    twist = in_register(hn::Set(d, product * (0.5F - part)));
    in_part = in_register(hn::Set(Ints(), (1 << kCoordBits) - 1));
    stride = in_register(hn::Set(Ints(), stride_bytes));
  }
  // How far the segments have moved since the first row of the band, 1/2^14 of a sample.
  [[nodiscard]] HWY_INLINE hn::Vec<Ints> at(const Band::SegmentPath& path, int j) const {
    const Floats d;
    const auto curved =
        hn::MulAdd(bow, hn::Load(d, path.curve + j), twist * hn::Load(d, path.twist + j));
    return small_ints(hn::MulAdd(band_fraction, hn::Load(d, path.span + j), curved));
  }

  hn::Vec<Floats> band_fraction;  // weights of span, curve and twist
  hn::Vec<Floats> bow;
  hn::Vec<Floats> twist;
  hn::Vec<Ints> in_part;  // the bits of a coordinate below a whole sample
  hn::Vec<Ints> stride;
};

// As describe_runs_at(), for runs that are steady.
template <class P, bool kThree>
HWY_INLINE void describe_steady_at(int j, const SteadyRow& steady, const Band& band, RunRow& row) {
  const Ints d;
  const auto x = steady.at(band.x_path, j);
  const auto y = hn::Load(d, band.y_from + j) + steady.at(band.y_path, j);
  const auto y_part = hn::And(y, steady.in_part);
  const auto y_coord = kThree ? hn::ShiftLeft<14 + kThreeShift>(y_part)
                              : hn::ShiftLeft<16>(hn::ShiftRight<2>(y_part));
  const auto x_of = [&](auto part) HWY_ATTR {
    const auto from = hn::Load(d, band.x_from[decltype(part)::value] + j) + x;
    return Part{hn::ShiftRight<kCoordBits>(from), hn::ShiftRight<2>(hn::And(from, steady.in_part))};
  };
  store_segments<P>(j, x_of, y_coord, hn::ShiftRight<kCoordBits>(y) * steady.stride, row);
}

// Describes a row whose runs are all steady and read the same number of rows.
template <class P, bool kThree>
void describe_alike(float band_fraction, std::int32_t stride, const Band& band, RunRow& row) {
  // A copy: for all that the compiler knows, each store into `row` might change row.count.
  const int count = row.count;
  const SteadyRow steady(band_fraction, stride);
  for (int j = 0; j < count; j += static_cast<int>(hn::MaxLanes(Ints()))) {
    describe_steady_at<P, kThree>(j, steady, band, row);
  }
}

// A DescribeRuns. `kThird`: third differences of the middles count.
template <class P, bool kThird>
SlowBlocks describe_all(const SourceBounds& bounds, const RowBetweenNodes* between,
                        const Band& band, float band_fraction, RunRow& row) {
  constexpr int kVector = static_cast<int>(hn::MaxLanes(Ints()));
  if (band.marks != 0) {
    const bool three = !P::kPerPixel && band.marks == kSteadyThree;
    three ? describe_alike<P, true>(band_fraction, bounds.stride, band, row)
          : describe_alike<P, false>(band_fraction, bounds.stride, band, row);
    return 0;
  }
  const SteadyRow steady(band_fraction, bounds.stride);
  SlowBlocks slow = 0;
  for (int j = 0; j < row.count; j += kVector) {
    const Band::Kind kind = P::kRun == 8 ? band.kind[j] : Band::Kind::kMixed;
    const bool needs_middles = kind == Band::Kind::kHighSlope || kind == Band::Kind::kMixed;
    if (needs_middles && between != nullptr) {
      interpolate(*between, j, kVector + 2 * kMargin, row.x, row.y);
    }
    if (kind == Band::Kind::kHighSlope || kind == Band::Kind::kEmpty) {
      slow |= slow_block(j);
    } else if (kind == Band::Kind::kSteady) {
      if (!P::kPerPixel && row.marks[j] == kSteadyThree) {
        describe_steady_at<P, true>(j, steady, band, row);
      } else {
        describe_steady_at<P, false>(j, steady, band, row);
      }
    } else {
      const AxisParabola x = parabola_of<P::kRun>(differences_at<kThird>(row.x + j));
      const AxisParabola y = parabola_of<P::kRun>(differences_at<kThird>(row.y + j));
      if (describe_runs_at<P>(j, x, y, bounds, row)) slow |= slow_block(j);
    }
  }
  return slow;
}

void interpolate_row(const RowBetweenNodes& between, int runs, std::int32_t* x, std::int32_t* y) {
  interpolate(between, 0, runs + 2 * kMargin + kSpare, x, y);
}

int group_of(PixelLayout layout, int run) {
  int group = kLanes;
  with_vector_layout(layout, run,
                     [&](auto vector_layout) { group = decltype(vector_layout)::kGroup; });
  return group;
}

#endif

// A DescribeRuns for layouts without a bilinear kernel.
SlowBlocks describe_slow(const SourceBounds& /*bounds*/, const RowBetweenNodes* between,
                         const Band& /*band*/, float /*band_fraction*/, RunRow& row) {
  if (between != nullptr) interpolate_row(*between, row.count, row.x, row.y);
  std::fill_n(row.marks, row.count, kLeftOut);
  return kAllSlow;
}

DescribeRuns describer_of([[maybe_unused]] PixelLayout layout, [[maybe_unused]] int run,
                          [[maybe_unused]] bool strongly_bent) {
  DescribeRuns describer = &describe_slow;
#if HWY_TARGET != HWY_SCALAR
  with_vector_layout(layout, run, [&](auto vector_layout) {
    using P = decltype(vector_layout);
    describer = strongly_bent ? &describe_all<P, true> : &describe_all<P, false>;
  });
#endif
  return describer;
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(interpolate_row);
HWY_EXPORT(describer_of);
HWY_EXPORT(group_of);

void interpolate_runs(const RowBetweenNodes& between, int runs, std::int32_t* x,
                      std::int32_t* y) noexcept {
  HWY_DYNAMIC_DISPATCH(interpolate_row)(between, runs, x, y);
}

DescribeRuns run_describer(PixelLayout layout, int run, bool strongly_bent) noexcept {
  return HWY_DYNAMIC_DISPATCH(describer_of)(layout, run, strongly_bent);
}

int run_group(PixelLayout layout, int run) noexcept {
  return HWY_DYNAMIC_DISPATCH(group_of)(layout, run);
}

}  // namespace calvin::remap
#endif
