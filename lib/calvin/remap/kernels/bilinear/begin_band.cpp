// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Begins a band, for every instruction set: finds the runs that are well inside the source in all
// of its rows and change nearly linearly, and prepares the source coordinates of their samples.

// Ice Lake and Zen 4 permute all bytes of a vector: remap/kernels/bilinear/blend_rows.cpp.
#define HWY_WANT_AVX3_DL 1

#include "calvin/core/vector_targets.hpp"
#include "calvin/remap/kernels/bilinear/bilinear_kernel.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/kernels/bilinear/begin_band.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/kernels/bilinear/parabolas-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

bool begin_band_of(PixelLayout /*layout*/, int /*run*/, const SourceBounds& /*bounds*/,
                   const NodeRows& /*nodes*/, int /*slot*/, float /*height*/, Band& /*band*/,
                   RunRow& /*row*/) {
  return false;
}

#else

// How far the middles of a steady run may deviate from a line down the band: a quarter of a sample,
// in 1/2^14. A run is inside the source if its first and last row are, by more than this.
constexpr std::int32_t kMaxBulge = 1 << (kCoordBits - 2);

// One axis of a vector of runs in a band. Coordinates and distances are in 1/2^14 of a sample.
struct BandAxis {
  AxisParabola first;       // in the first row
  AxisParabola last;        // in the last row
  hn::Vec<Ints> half;       // the largest distance of a sample from the run's middle
  hn::Vec<Ints> least;      // the smallest coordinate in the band
  hn::Vec<Ints> most;       // the largest
  hn::Vec<Ints> abs_slope;  // the largest absolute value of the slope, 2.14
  hn::Vec<Ints> bent;       // likewise of the bend, 4.12
  hn::Vec<Ints> deviation;  // as kMaxDeviation
};

// The middles of a run down the band. Between four nodes they are a cubic whose second derivative
// changes linearly from the second difference at the second node to the one at the third. A
// function whose second derivative is at most d deviates from its chord over h by d h^2 / 8.
struct Bulge {
  hn::Vec<Ints> line;     // the largest deviation from a line, 1/2^14 of a sample
  hn::Vec<Floats> twist;  // as in Band
};
HWY_INLINE Bulge bulge(const float (&rows)[4][NodeRows::kRuns], int j, int slot, float height) {
  const Floats d;
  const auto node = [&](int r) HWY_ATTR { return hn::Load(d, rows[(slot + r) % 4] + j); };
  const auto upper = node(0) - node(1) - node(1) + node(2);
  const auto lower = node(1) - node(2) - node(2) + node(3);
  const auto square = height * height;
  const auto most = hn::Max(hn::Abs(upper), hn::Abs(lower)) * hn::Set(d, square / 8);
  // NearestInt() needs numbers that fit into 32 bits. 64 more are for rounding.
  const auto line = hn::NearestInt(hn::Min(most, hn::Set(d, 1e9F))) + hn::Set(Ints(), 64);
  return {line, (lower - upper) * hn::Set(d, square * height / 6)};
}

// Rounded up to a multiple of 4: in 4.12 it is then exact.
HWY_INLINE hn::Vec<Ints> whole_coord(hn::Vec<Ints> half) {
  const Ints d;
  return hn::And(half + hn::Set(d, 3), hn::Set(d, ~3));
}

// `reach` is how far from the middle the kernel reads even where the run needs less; `slack` is how
// far the middles may deviate from a line down the band.
template <bool kThird>
HWY_INLINE BandAxis band_axis(const std::int32_t* first, const std::int32_t* halfway,
                              const std::int32_t* last, hn::Vec<Ints> slack, std::int32_t reach) {
  RunDifferences top = differences_at<kThird>(first);
  RunDifferences bottom = differences_at<kThird>(last);
  const auto across = differences_at<kThird>(halfway).across;
  const auto deviation = across + across - top.across - bottom.across;
  // The line is off by the least half way towards the value in the middle of the band.
  top.across = top.across + hn::ShiftRight<2>(deviation);
  bottom.across = bottom.across + hn::ShiftRight<2>(deviation);
  const AxisParabola a = parabola_of<8>(top);
  const AxisParabola b = parabola_of<8>(bottom);
  // Where the vector is not steady, `half` may be too small: it is not used then.
  const auto half =
      whole_coord(hn::Max(half_of<8>(a), half_of<8>(b)) + hn::Set(Ints(), kMaxDeviation));
  const auto around = hn::Max(half, hn::Set(Ints(), reach)) + slack;
  return {a,
          b,
          half,
          hn::Min(a.middle, b.middle) - around,
          hn::Max(a.middle, b.middle) + around,
          hn::Max(hn::Abs(a.slope), hn::Abs(b.slope)),
          hn::Max(hn::Abs(a.bend), hn::Abs(b.bend)),
          hn::Abs(deviation)};
}

// Replaces what lies behind a row's last run by a copy of it, which makes no vector slow.
class RunsHeld {
  static constexpr int kAll = static_cast<int>(hn::MaxLanes(Ints()));

 public:
  explicit RunsHeld(int runs) : runs_(runs) {}

  [[nodiscard]] HWY_INLINE hn::Vec<Ints> operator()(hn::Vec<Ints> v) const {
    if (all()) return v;
    alignas(64) std::int32_t lanes[kAll];
    for (int i = 0; i < kAll; ++i) lanes[i] = std::min(i, runs_ - 1);
    return hn::TableLookupLanes(v, hn::SetTableIndices(Ints(), lanes));
  }
  [[nodiscard]] HWY_INLINE hn::Vec<Floats> operator()(hn::Vec<Floats> v) const {
    return all() ? v : hn::BitCast(Floats(), (*this)(hn::BitCast(Ints(), v)));
  }
  [[nodiscard]] HWY_INLINE BandAxis operator()(const BandAxis& axis) const {
    if (all()) return axis;
    const auto parabola = [&](const AxisParabola& l) HWY_ATTR {
      return AxisParabola{(*this)(l.middle), (*this)(l.slope), (*this)(l.bend)};
    };
    return {parabola(axis.first), parabola(axis.last),    (*this)(axis.half),
            (*this)(axis.least),  (*this)(axis.most),     (*this)(axis.abs_slope),
            (*this)(axis.bent),   (*this)(axis.deviation)};
  }

 private:
  [[nodiscard]] bool all() const { return runs_ >= kAll; }

  int runs_;
};

// The rows of the source that each of a vector of runs reads.
template <class P>
HWY_INLINE int rows_of(const BandAxis& y) {
  const Ints d;
  const std::int32_t half = hn::GetLane(hn::MaxOfLanes(d, y.half));
  // Where three rows suffice, the middle one is nearest to the run's middle.
  return P::kPerPixel || half <= kHalfRow ? 3 : (half >> (kCoordBits - 1)) + 3;
}

// How much is left between the slopes of the runs and the highest slopes for which a segment holds
// all samples of a run; negative where a slope is too high. `rows` is what the runs read.
template <class P>
HWY_INLINE hn::Vec<Ints> room_of(const BandAxis& x, const BandAxis& y, const SourceBounds& b,
                                 int rows) {
  const Ints d;
  // 0x400 / 2^14 = 1/16: slopes change within the band.
  const auto room = [&](const BandAxis& axis, std::int32_t max_slope) HWY_ATTR {
    return hn::Set(d, max_slope - 0x400) - axis.abs_slope - hn::ShiftLeft<3>(axis.bent);
  };
  const auto across = [&](const BandAxis& axis)
                          HWY_ATTR { return hn::ShiftRight<kCoordBits - 1>(axis.half); };
  return hn::Min(
      hn::Min(room(x, b.max_slope), room(y, rows == 3 && !P::kPerPixel ? kMaxSlopeDown : 0x7FFF)),
      hn::Min(hn::Set(d, b.max_columns - 2) - across(x),
              hn::Set(d, kMaxSourceRows - 3) - across(y)));
}

// How far the runs are from the ends of the source; negative where they reach beyond.
HWY_INLINE hn::Vec<Ints> margin_of(const BandAxis& x, const BandAxis& y, const SourceBounds& b,
                                   int rows) {
  const Ints d;
  const auto last = [&](const BandAxis& axis)
                        HWY_ATTR { return hn::ShiftRight<kCoordBits>(axis.most); };
  // Three rows begin half a row before the middle: the last one is the row behind that of `most`.
  const int behind = rows == 3 ? 2 : rows;
  const auto last_row = hn::Set(d, std::min(b.last_row - 1, b.rows - b.guarded_rows - behind));
  const auto first = [&](const BandAxis& axis, std::int32_t sample)
                         HWY_ATTR { return axis.least - hn::Set(d, sample << kCoordBits); };
  return hn::Min(hn::Min(first(x, b.first_column), first(y, b.first_row)),
                 hn::Min(hn::Set(d, b.last_column - 1) - last(x), last_row - last(y)));
}

// Whether windows hold all pixels of a vector of steady runs. A window is three rows of the source
// from the run's first row on: with four components eight columns from the run's first column on,
// with three components 16 bytes, from there or from a lane's first pixel on.
template <class P>
HWY_INLINE bool fit_windows(const BandAxis& x, const BandAxis& y) {
  const Ints d;
  auto spare = hn::Set(d, kHalfRow) - y.half;
  if constexpr (P::kStep == 4) {
    spare = hn::Min(spare, hn::Set(d, 7 * kHalfRow) - x.half);
  } else {
    // A lane has eight results of three components. From its first pixel that is three steps to the
    // first byte of the last pixel, or two steps to its last byte.
    const auto bent = hn::ShiftLeft<2>(x.bent) + hn::Set(d, kMaxDeviation);
    const auto least = hn::Min(x.first.slope, x.last.slope);
    const auto two = x.abs_slope + x.abs_slope + bent;
    // The first lane begins with the run, `half` before its middle, and ends in its third
    // pixel, 1.5 samples before the middle.
    const auto begins = x.half - least - hn::ShiftRight<1>(least) + bent;
    spare = hn::Min(hn::Min(spare, least - bent),
                    hn::Min(hn::Set(d, 6 * kHalfRow) - hn::Max(two, begins),
                            hn::Set(d, 8 * kHalfRow) - two - x.abs_slope));
  }
  return hn::AllFalse(d, hn::Lt(spare, hn::Zero(d)));
}

// Whether all runs of a vector lie outside of the source all down the band, by a sample or more.
HWY_INLINE bool is_empty(const BandAxis& x, const BandAxis& y, const SourceBounds& b) {
  const Ints d;
  const auto inside = [&](const BandAxis& axis, std::int32_t count) HWY_ATTR {
    return hn::Min(hn::ShiftRight<kCoordBits>(axis.most) + hn::Set(d, 2),
                   hn::Set(d, count) - hn::ShiftRight<kCoordBits>(axis.least));
  };
  return hn::AllTrue(d, hn::Lt(hn::Min(inside(x, b.columns), inside(y, b.rows)), hn::Zero(d)));
}

// The kind of a vector of runs, with middles near a line down the band, that read `rows` rows.
template <class P>
HWY_INLINE Band::Kind kind_of(const BandAxis& x, const BandAxis& y, const SourceBounds& bounds,
                              int rows) {
  const Ints d;
  const auto none = [&](hn::Vec<Ints> spare)
                        HWY_ATTR { return hn::AllFalse(d, hn::Lt(spare, hn::Zero(d))); };
  if (bounds.fills && is_empty(x, y, bounds)) return Band::Kind::kEmpty;
  const auto room = room_of<P>(x, y, bounds, rows);
  const bool inside = none(margin_of(x, y, bounds, rows));
  if (!none(room)) {
    // At the ends of the source some of the runs may still be taken, row by row.
    const bool all = hn::AllTrue(d, hn::Lt(room, hn::Zero(d)));
    return inside || all ? Band::Kind::kHighSlope : Band::Kind::kMixed;
  }
  const bool straight = none(hn::Set(d, kMaxDeviation) - hn::Max(x.deviation, y.deviation));
  return inside && straight ? Band::Kind::kSteady : Band::Kind::kMixed;
}

// RunRow::marks of a vector of runs that reads `rows` rows; for mixed runs it is found row by row.
HWY_INLINE RunMarks marks_of(Band::Kind kind, int rows) {
  switch (kind) {
    case Band::Kind::kSteady:
      return rows | RunMark::kSteady;
    case Band::Kind::kHighSlope:
      return kLeftOut;
    case Band::Kind::kEmpty:
      return kLeftOut | RunMark::kEmpty;
    default:
      return 0;
  }
}

// Writes the paths of the segments of a steady vector of runs down the band.
HWY_INLINE void begin_path(int j, const BandAxis& axis, hn::Vec<Ints> halfway,
                           hn::Vec<Floats> twist, Band::SegmentPath& path) {
  const Floats floats;
  const auto down = axis.last.middle - axis.first.middle;
  const auto half = halfway - axis.first.middle;
  const auto curve = hn::ShiftLeft<2>(half) - hn::ShiftLeft<1>(down);
  hn::Store(hn::ConvertTo(floats, down), floats, path.span + j);
  hn::Store(hn::ConvertTo(floats, curve), floats, path.curve + j);
  hn::Store(twist, floats, path.twist + j);
}

// Writes where the segments of a steady vector of runs begin in the first row. `to_middles` become
// records of the distance to the middles, without the beginning's part of a sample or row.
template <class P, bool kThree>
HWY_INLINE void begin_segments(int j, const BandAxis& x, const BandAxis& y, Band& band,
                               std::int32_t* to_middles) {
  const Ints d;
  const auto rounding = hn::Set(d, 2);
  const auto y_half = kThree ? hn::Set(d, kHalfRow) : y.half;
  // With three rows y is counted from the middle row, which is half a row behind the beginning.
  const auto y_to_middle =
      kThree ? hn::Set(d, -(kHalfRow << (14 + kThreeShift))) : hn::ShiftLeft<14>(y_half);
  const auto y_from = y.first.middle - y_half;
  hn::Store(kThree ? y_from : y_from + rounding, d, band.y_from + j);
  std::array<hn::Vec<Ints>, P::kParts> records;
  for_parts<P>([&](auto which) HWY_ATTR {
    constexpr int kPart = decltype(which)::value;
    const auto half =
        whole_coord(hn::Max(part_half<P, kPart>(x.first), part_half<P, kPart>(x.last)) +
                    hn::Set(d, kMaxDeviation));
    hn::Store(x.first.middle - half + rounding, d, band.x_from[kPart] + j);
    records[which] = in_order<P>(packed(hn::ShiftRight<2>(half), y_to_middle));
  });
  store_parts<P>([&](std::size_t part) HWY_ATTR { return records[part]; }, to_middles);
}

// Writes the slopes, bends and shapes of a steady vector of runs.
template <class P, bool kThree>
HWY_INLINE void begin_shapes(int j, const BandAxis& x, const BandAxis& y,
                             const std::int32_t* to_middles, Band& band) {
  const Ints d;
  constexpr int kVector = static_cast<int>(hn::MaxLanes(d));
  const auto both = [&](hn::Vec<Ints> of_x, hn::Vec<Ints> of_y) HWY_ATTR {
    return in_order<P>(packed(of_x, hn::ShiftLeft<16 + (kThree ? kThreeShift : 0)>(of_y)));
  };
  hn::Store(both(x.first.slope, y.first.slope), d, band.slope[0] + j);
  hn::Store(both(x.last.slope, y.last.slope), d, band.slope[1] + j);
  hn::Store(both(x.first.bend, y.first.bend), d, band.bend[0] + j);
  hn::Store(both(x.last.bend, y.last.bend), d, band.bend[1] + j);
  const CoordNumbers<P> numbers;
  for (int i = 0; i < kVector; i += P::kSamples / P::kRun) {
    const int run = j + i;
    const BothAxes<P> first = shape_of<P>(band.slope[0] + run, band.bend[0] + run);
    const BothAxes<P> last = shape_of<P>(band.slope[1] + run, band.bend[1] + run);
    const BothAxes<P> middle = spread_records<P, P::kRun / P::kParts>(to_middles + i * P::kParts);
    const int at = run * P::kRun;
    hn::Store(middle.x + first.x, numbers, band.x_shape + at);
    hn::Store(middle.y + first.y, numbers, band.y_shape + at);
    hn::Store(last.x - first.x, numbers, band.x_change + at);
    hn::Store(last.y - first.y, numbers, band.y_change + at);
  }
}

// Prepares a steady vector of runs. Not inlined: it is the same with and without third differences,
// and half of the work of compiling this file.
template <class P, bool kThree>
HWY_NOINLINE void begin_vector(int j, const BandAxis& x, const BandAxis& y, Band& band) {
  // spread_records() reads four records at a time, from any record on: hence four more.
  alignas(64) std::int32_t to_middles[P::kParts * hn::MaxLanes(Ints()) + 4];
  begin_segments<P, kThree>(j, x, y, band, to_middles);
  begin_shapes<P, kThree>(j, x, y, to_middles, band);
}

// As begin_band(), for a VectorLayout. `kThird`: third differences count.
template <class P, bool kThird>
HWY_INLINE bool begin_bands(const SourceBounds& bounds, const NodeRows& nodes, int slot,
                            float height, Band& band, RunRow& row) {
  const Ints d;
  constexpr int kVector = static_cast<int>(hn::MaxLanes(Ints()));
  const auto most = hn::Set(d, kMaxBulge);
  bool shared = true;
  for (int j = 0; j < row.count; j += kVector) {
    const auto x_bulge = bulge(nodes.x, j + NodeRows::kFirst, slot, height);
    const auto y_bulge = bulge(nodes.y, j + NodeRows::kFirst, slot, height);
    const RunsHeld held(row.count - j);
    const BandAxis x = held(band_axis<kThird>(band.x_first + j, band.x_halfway + j, band.x_last + j,
                                              hn::Min(x_bulge.line, most), 0));
    const BandAxis y = held(band_axis<kThird>(band.y_first + j, band.y_halfway + j, band.y_last + j,
                                              hn::Min(y_bulge.line, most),
                                              P::kPerPixel ? 2 * kHalfRow : kHalfRow));
    const auto line = held(hn::Max(x_bulge.line, y_bulge.line));
    const bool tame = hn::AllFalse(d, hn::Gt(line, most));
    const int rows = rows_of<P>(y);
    if (tame) band.kind[j] = kind_of<P>(x, y, bounds, rows);
    const Band::Kind kind = band.kind[j];
    shared = shared && (kind == Band::Kind::kSteady || kind == Band::Kind::kEmpty);
    const bool by_windows = P::kPerPixel && kind == Band::Kind::kSteady && fit_windows<P>(x, y);
    const RunMarks of_kind = marks_of(kind, rows);
    const RunMarks marks = by_windows ? of_kind | RunMark::kWindows : of_kind;
    hn::Store(hn::Set(d, marks), d, row.marks + j);
    const bool alike = j == 0 || marks == band.marks;
    band.marks = kind == Band::Kind::kSteady && alike ? marks : 0;
    if (kind != Band::Kind::kSteady) continue;
    if (!P::kPerPixel && rows == 3) {
      begin_vector<P, true>(j, x, y, band);
    } else {
      begin_vector<P, false>(j, x, y, band);
    }
    const auto halfway = [&](const std::int32_t* middles)
                             HWY_ATTR { return held(hn::LoadU(d, middles + j + kMargin)); };
    begin_path(j, x, halfway(band.x_halfway), held(x_bulge.twist), band.x_path);
    begin_path(j, y, halfway(band.y_halfway), held(y_bulge.twist), band.y_path);
  }
  return shared;
}

bool begin_band_of(PixelLayout layout, int run, const SourceBounds& bounds, const NodeRows& nodes,
                   int slot, float height, Band& band, RunRow& row) {
  band.clear();
  bool shared = false;
  if (run != 8) return shared;
  with_vector_layout(layout, run, [&](auto vector_layout) HWY_ATTR {
    using P = decltype(vector_layout);
    if constexpr (P::kRun == 8) {
      shared = bounds.strongly_bent ? begin_bands<P, true>(bounds, nodes, slot, height, band, row)
                                    : begin_bands<P, false>(bounds, nodes, slot, height, band, row);
    }
  });
  return shared;
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(begin_band_of);

bool begin_band(PixelLayout layout, int run, const SourceBounds& bounds, const NodeRows& nodes,
                int slot, float height, Band& band, RunRow& row) noexcept {
  return HWY_DYNAMIC_DISPATCH(begin_band_of)(layout, run, bounds, nodes, slot, height, band, row);
}

}  // namespace calvin::remap
#endif
