// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One row of an output plane as runs of 8 samples whose places in the source plane are a parabola
// through the middles of a run and its neighbours (of 4 or 2 where the map is strongly bent).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace calvin::remap {

// Places are in 1/2^14 of a sample of the source plane.
inline constexpr int kPlaceBits = 14;

// What is worked on at a time: its arrays stay in the nearest cache.
inline constexpr int kChunkRuns = 256;

// A run for which there is no quick way is marked by one more than any number of rows, one that
// shows nothing of the source, but the fill, by another too, and where there is no quick way for
// all of its group by a third.
inline constexpr std::int32_t kSlowRun = 64;
inline constexpr std::int32_t kEmptyRun = 128;
inline constexpr std::int32_t kSlowGroup = 256;

// Which runs of a row are slow is known by blocks of so many.
inline constexpr int kBlockOfRuns = 16;
using SlowBlocks = std::uint32_t;  // a bit for each
inline constexpr SlowBlocks kAllSlow = ~SlowBlocks{0};
[[nodiscard]] constexpr SlowBlocks slow_block(int run) noexcept {
  return SlowBlocks{1} << (run / kBlockOfRuns);
}

// What is added to the rows of runs whose samples a band has in common.
inline constexpr std::int32_t kSteadyRows = 32;
inline constexpr std::int32_t kSteadyThree = kSteadyRows + 3;
[[nodiscard]] constexpr bool is_steady(std::int32_t rows) noexcept {
  return (rows & kSteadyRows) != 0;
}

// Likewise of those whose pixels are where windows into three rows hold them in all of the band.
inline constexpr std::int32_t kWindowRows = 16;
[[nodiscard]] constexpr bool is_window(std::int32_t rows) noexcept {
  return (rows & kWindowRows) != 0;
}

// Runs before the first one and behind the last one that a run's parabola is made with.
inline constexpr int kMargin = 2;
// Runs behind a row's last one that fill up its last vector.
inline constexpr int kSpare = 3;

// Where the middles of runs are between the columns of the map's nodes: the first of four, and the
// weights of the first, the third and the fourth one.
struct RunColumns {
  const std::int32_t* column;
  std::array<const float*, 3> weights;
};

// One coordinate of a row of nodes: `scale` times it, less `offset`, is a place of the source.
struct NodeLine {
  const float* nodes;
  int count;
  float scale;
  float offset;
};

// A chunk of runs, and its margins, at four rows of the map's nodes. The first run is at kFirst, so
// that vectors of runs are loaded at once.
struct NodeRows {
  static constexpr int kFirst = 16;
  static constexpr int kRuns = kChunkRuns + 48;
  alignas(64) float x[4][kRuns];
  alignas(64) float y[4][kRuns];
};

// A row of the output between them: what is added to the first one are these parts of how much the
// others differ from it. Thus what is the same in all of them stays as it is.
struct RowNodes {
  const NodeRows& nodes;
  std::array<float, 4> weights;
};

// The same at one row of the output, and what a vector kernel has to know of each run.
struct RunRow {
  static constexpr int kRuns = NodeRows::kRuns;
  // Where runs fill several lanes each of them may have a segment of its own.
  static constexpr int kMostParts = 4;
  // Middles of the runs, margins included.
  alignas(64) std::int32_t x[kRuns];
  alignas(64) std::int32_t y[kRuns];
  // Of the runs, without margins. Bytes from the beginning of the plane to the segment that
  // holds the run's samples; rows of the source that its group takes, and the marks above.
  alignas(64) std::int32_t offset[kRuns];
  alignas(64) std::int32_t rows[kRuns];
  // Two 16-bit numbers each, of x and of y. Slope, 2.14; what the parabola adds at the run's ends,
  // 4.12; place of the middle from the first sample of the segment, 4.12. All that is of y is eight
  // times as large for runs that take three rows, and from the middle one of them.
  alignas(64) std::int32_t slope[kRuns];
  alignas(64) std::int32_t bend[kRuns];
  alignas(64) std::int32_t middle[kMostParts * kRuns];       // by the lane
  alignas(64) std::int32_t lane_offset[kMostParts * kRuns];  // likewise
  int count = 0;                                             // runs
};

// Rows of the output that are prepared together, at most and at least: what varies little is taken
// once for all of them.
inline constexpr int kBandRows = 64;
inline constexpr int kFewestBandRows = 8;

// Twice as much as the distance of a run's neighbours may be off a line down a band in its middle,
// 1/2^14 of a sample: the run's ends are 1/4500 of a sample off a line that goes half way to it.
inline constexpr std::int32_t kMostSway = 64;

// What a band's rows share of the runs that are well inside the source in all of them.
struct Band {
  static constexpr int kRuns = RunRow::kRuns;
  static constexpr int kSamples = 8 * kRuns;
  // Middles in the first row, in the last, and in one amid them, margins included.
  alignas(64) std::int32_t x_first[kRuns];
  alignas(64) std::int32_t y_first[kRuns];
  alignas(64) std::int32_t x_last[kRuns];
  alignas(64) std::int32_t y_last[kRuns];
  alignas(64) std::int32_t x_amid[kRuns];
  alignas(64) std::int32_t y_amid[kRuns];
  // Of runs that are steady. Where the segment begins in the first row; of x by the lane.
  alignas(64) std::int32_t x_from[RunRow::kMostParts][kRuns];
  alignas(64) std::int32_t y_from[kRuns];
  // What is added to that, for a row at part t of the way to the last one: t times the span, and
  // t (1 - t) times the curve, and t (1 - t) (1/2 - t) times the twist.
  struct Course {
    alignas(64) float span[kRuns];
    alignas(64) float curve[kRuns];
    alignas(64) float twist[kRuns];
  };
  Course x_course;
  Course y_course;
  // RunRow::slope and bend in the first row and in the last.
  alignas(64) std::int32_t slope[2][kRuns];
  alignas(64) std::int32_t bend[2][kRuns];
  // Of the samples: where they are from the segment's beginning in the first row, less what that
  // is off a sample and a row, and what is added until the last one.
  alignas(64) std::int16_t x_shape[kSamples];
  alignas(64) std::int16_t y_shape[kSamples];
  alignas(64) std::int16_t x_turn[kSamples];
  alignas(64) std::int16_t y_turn[kSamples];
  // What all rows have in common, by the first run of a vector: nothing; what is above, and that
  // RunRow::rows has kSteadyRows; only RunRow::rows, by which there is no quick way, since the runs
  // are too steep or empty.
  enum class Kind : std::uint8_t { kMixed, kSteady, kSteep, kEmpty };
  Kind kind[kRuns];
  // RunRow::rows of all runs, if they are steady and have it in common; else 0.
  std::int32_t marks;

  // Rows have nothing in common.
  void clear() noexcept {
    std::fill(std::begin(kind), std::end(kind), Kind::kMixed);
    marks = 0;
  }
};

// The line of a run makes good for what a parabola cannot follow: this part, in 1/256, of the
// third difference of the middles is taken from the difference of the run's neighbours. 1/6 would
// be the slope in the middle, 1/7 is best for the whole run (Chebyshev).
inline constexpr int kThirdPart = 37;

// A run's places as a parabola, samples of the source; as the vector kernel makes them.
struct RunParabola {
  // `middles` of the run before the one before, and of the four that follow.
  RunParabola(const std::int32_t* middles, int pixels) noexcept {
    constexpr double kScale = 1.0 / (1 << kPlaceBits);
    const double before = kScale * middles[1];
    const double after = kScale * middles[3];
    const double third = kScale * middles[4] - kScale * middles[0] - 2 * (after - before);
    middle = kScale * middles[2];
    const double part = 1.0 / pixels;
    slope = (after - before - third * (kThirdPart / 256.0)) * (0.5 * part);
    bend = (after + before - 2 * middle) * (0.5 * part * part);
  }
  // `t` samples of the output from the middle.
  [[nodiscard]] double at(double t) const noexcept { return middle + t * (slope + t * bend); }

  // Whether the whole run lies outside of 0..last by more than a sample.
  [[nodiscard]] bool misses(int reach, double last) const noexcept {
    const double far = reach * (std::abs(slope) + reach * std::abs(bend)) + 1;
    return middle + far < 0 || middle - far > last;
  }

  double middle;
  double slope;
  double bend;
};

// How samples lie in the source plane, and which places may be taken quickly.
struct SourceBounds {
  std::int32_t stride = 0;        // bytes
  std::int32_t first_column = 0;  // the first that shows something of the frame all by itself
  std::int32_t first_row = 0;
  std::int32_t last_column = 0;  // the last with a place in 0..last: its neighbour is there
  std::int32_t last_row = 0;
  std::int32_t widest = 0;  // columns that a segment holds, less one
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  std::int32_t guarded_rows = 1;   // rows at the end that must not be read past their end
  std::int32_t last_segment = 0;   // bytes in the last row before which a segment may begin
  std::int32_t steepest = 0x7FFF;  // slope along a row, 2.14
  bool strongly_bent = false;      // third differences count
  bool fills = false;              // what is outside of the source
};

// Kinds of memory that the vector kernels know: 8-bit samples of 1 to 4 components without gaps, or
// of 1 or 2 components in every second byte; 16-bit samples of 1 or 2 components.
enum class LaneLayout : std::uint8_t {
  kOne,
  kTwo,
  kThree,
  kFour,
  kOneSpread,
  kTwoSpread,
  kOneWord,
  kTwoWords,
  kNone
};

// Pixels that a vector kernel makes in 128 bits.
[[nodiscard]] constexpr int lane_pixels(LaneLayout layout) noexcept {
  switch (layout) {
    case LaneLayout::kTwo:
    case LaneLayout::kTwoSpread:
      return 4;
    case LaneLayout::kThree:
    case LaneLayout::kFour:
      return 2;
    default:  // words too
      return 8;
  }
}

// Planes that share their places: the U and V of I420.
inline constexpr int kMaxPlanes = 2;
struct PlaneRows {
  const std::uint8_t* source[kMaxPlanes];
  std::uint8_t* output[kMaxPlanes];
  int planes = 1;
};

// Of the runs from `first` on.
void expand_runs(const RunColumns& runs, int first, int count, const NodeLine& line,
                 float* to) noexcept;

// The first `runs` of the chunk, and its margins.
void interpolate_runs(const RowNodes& between, int runs, std::int32_t* x, std::int32_t* y) noexcept;

// Takes together what the rows of a band, whose first and last one's middles and those amid them
// are known, have in common, for runs of `run` samples. All of them lie between the same of the
// nodes' rows, the first of which is at `slot`; `height` is how much of the way between those the
// band takes. Whether each of the runs is steady, or empty: then no row needs its middles.
bool begin_band(LaneLayout layout, int run, const SourceBounds& bounds, const NodeRows& nodes,
                int slot, float height, Band& band, RunRow& row) noexcept;

// What the vector kernel has to know of the `row.count` runs of `run` samples: 8, or as many as a
// lane has; which of them are slow. What is quick in a group of run_group() is so at the cost
// of the slow ones' samples, which are written first. Middles of runs that are not steady are
// interpolated on the way, unless `between` is nullptr and all of them are known or there are none;
// `way` is as in RowTask.
using DescribeRuns = SlowBlocks (*)(const SourceBounds& bounds, const RowNodes* between,
                                    const Band& band, float way, RunRow& row);
[[nodiscard]] DescribeRuns run_describer(LaneLayout layout, int run, bool strongly_bent) noexcept;

// How 16-bit samples hold their values.
struct WordFormat {
  bool swapped = false;  // big-endian on a little-endian machine, or the other way round
  int shift = 0;         // bits below the value
};

// A row whose runs are described.
struct RowTask {
  const RunRow& row;
  const Band& band;
  float way;  // how much of the band's height lies above the row, 0..1
  std::int32_t stride;
  bool nearest;
  WordFormat format;  // of 16-bit samples
};

// Writes the samples of the groups of runs from `begin` to before `end` that are not slow,
// something for the slow runs in them, and run_slack() bytes that follow a group; what `planes`
// name is where `begin` goes to.
using BlendRuns = void (*)(const RowTask& task, int begin, int end, const PlaneRows& planes);
[[nodiscard]] BlendRuns run_blender(LaneLayout layout, int run, bool nearest, int planes) noexcept;

// The samples of the source along an axis, and between which places it shows something.
struct AxisEnds {
  int count = 0;
  float low = 0;
  float high = 0;
  float first = 0;      // what is replicated before
  int last = 0;         // the last sample that is where its number says
  bool uneven = false;  // there is one behind it
};

// A row of the output whose middles are known, and what the source shows there.
struct GatherTask {
  const RunRow& row;
  std::int32_t stride;
  AxisEnds x_ends;
  AxisEnds y_ends;
  bool nearest;
  bool fills;          // what is outside of the source
  bool mirrors;        // likewise; else it is replicated
  std::uint32_t fill;  // the memory of a pixel, in its lowest bytes
  WordFormat format;   // of 16-bit samples
};

// Writes the samples of `count` runs of 8, be they as steep as they may. `left` of each of them is
// whether it could not be taken: then anything was written; returns whether there is such a run.
// `output` is the first sample of the row's first run.
bool gather_runs(LaneLayout layout, const GatherTask& task, const std::int32_t* runs, int count,
                 const std::uint8_t* source, std::uint8_t* output, bool* left) noexcept;

// Memory whose components lie within 32 bits, and the kernel that it is resampled with.
struct WideFormat {
  int taps = 4;  // bicubic, 6: Lanczos
  int components = 1;
  int component_bits = 8;  // from one to the next
  int pixel_step = 1;      // bytes
  bool words = false;      // 16-bit samples
  WordFormat word;
  float largest = 255;
  int spare = 3;  // columns at the end whose 32 bits may reach beyond the row
};

// Bicubic or Lanczos over the `row.count` runs of 8 samples that are not slow. Those that it cannot
// take are slow afterwards. `output` is the first sample of the chunk.
void blend_wide_runs(const WideFormat& format, const SourceBounds& bounds, RunRow& row,
                     const std::uint8_t* source, std::uint8_t* output) noexcept;

// Runs that the kernel takes at a time on this machine: 1, 2 or 4.
[[nodiscard]] int run_group(LaneLayout layout, int run) noexcept;

[[nodiscard]] constexpr int run_slack(LaneLayout layout) noexcept {
  switch (layout) {
    case LaneLayout::kThree:
      return 4;
    case LaneLayout::kOneSpread:
    case LaneLayout::kTwoSpread:
      return 1;
    default:
      return 0;
  }
}

}  // namespace calvin::remap
