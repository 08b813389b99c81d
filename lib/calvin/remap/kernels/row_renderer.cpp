// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The row renderer: takes a chunk of runs down the rows of a plane, band by band, and gives each
// run to the quickest kernel that can take it.

#include "calvin/remap/kernels/row_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "calvin/remap/kernels/bicubic/bicubic_kernel.hpp"
#include "calvin/remap/kernels/bilinear/bilinear_kernel.hpp"
#include "calvin/remap/kernels/choice.hpp"
#include "calvin/remap/kernels/gather/gather_kernel.hpp"
#include "calvin/remap/kernels/scalar/scalar_kernel.hpp"

namespace calvin {

namespace {

using remap::NodeRows;
using remap::RunRow;

// Takes a chunk of runs down the rows.
class RowRenderer {
 public:
  RowRenderer(const PlaneMap& map, const PlaneLayout& layout,
              std::span<const PlaneMemory<const std::uint8_t>> sources,
              std::span<const PlaneMemory<std::uint8_t>> outputs, const Sampling& sampling,
              int first_run, remap::RowScratch& scratch)
      : map_(map),
        layout_(layout),
        sources_(sources),
        outputs_(outputs),
        sampling_(sampling),
        choice_(remap::choose_kernel(map, layout, sampling, sources)),
        describe_runs_(remap::run_describer(choice_.pixel_layout, map.run_pixels(),
                                            choice_.bounds.strongly_bent)),
        blend_runs_(remap::run_blender(choice_.pixel_layout, map.run_pixels(), is_nearest(),
                                       static_cast<int>(sources.size()))),
        words_(remap::word_format(layout)),
        group_(choice_.bicubic ? 1 : remap::run_group(choice_.pixel_layout, map.run_pixels())),
        pixels_(map.run_pixels()),
        first_run_(first_run),
        first_(first_run * map.run_pixels()),
        scratch_(scratch),
        nodes_(scratch.nodes),
        band_(scratch.band),
        row_(scratch.row) {
    runs_ = std::min(remap::kChunkRuns, map.runs() - first_run);
    width_ = std::min(runs_ * pixels_, map.size().width - first_);
    row_.count = runs_;
    // A group is whole where all that it writes, with the slack behind it, is within the row. An
    // uneven last sample is in no group.
    const auto step = static_cast<int>(layout.pixel_step);
    const int slack = (remap::run_slack(choice_.pixel_layout) + step - 1) / step;
    const int left = map.size().width - first_ - slack - (map.output_x().is_even() ? 0 : 1);
    whole_groups_ = std::max(left, 0) / (group_ * pixels_);
    // fill_ has the first four bytes of a filled pixel: the gather kernel takes no larger ones.
    std::array<std::uint8_t, 16> pixel{};
    remap::fill_span(layout, {pixel.data(), 0}, {row_, 0, 0, 1, nullptr});
    std::memcpy(&fill_, pixel.data(), sizeof fill_);
  }

  // Renders the row `y` of the output; rows must come in order.
  void row(int y) noexcept {
    const PlaneMap::Row* limits = map_.limits(y);
    // An uneven last sample is not where the parabola of its run says.
    const bool uneven = !map_.output_x().is_even();
    if (y >= band_end_) begin_band(y);
    band_fraction_ = std::min(static_cast<float>(y - band_begin_) * band_fraction_per_row_, 1.0F);
    const bool all = choice_.bicubic || uneven || limits != nullptr;
    const remap::SlowBlocks slow = describe(y, limits, all);
    if (limits != nullptr) mark_invalid(*limits);
    if (uneven) mark_slow(whole_groups_ * group_, row_.count);
    blend(y);
    sample_rest(y, limits, all ? remap::kAllSlow : slow);
  }

 private:
  // Finds where the runs lie and which of them are slow. `all`: all middles are needed.
  remap::SlowBlocks describe(int y, const PlaneMap::Row* limits, bool all) noexcept {
    const auto describe_with = [this](const remap::RowBetweenNodes* between) {
      return describe_runs_(choice_.bounds, between, band_, band_fraction_, row_);
    };
    if (!all && band_shared_) return describe_with(nullptr);
    const remap::RowBetweenNodes between = nodes_at(map_.level(y));
    if (!all) return describe_with(&between);
    remap::interpolate_runs(between, runs_, row_.x, row_.y);
    if (limits != nullptr) take_middles(*limits);
    if (!choice_.bicubic) return describe_with(nullptr);
    std::fill_n(row_.marks, row_.count, 0);
    return remap::kAllSlow;
  }

  // Begins the band of row `y`. It does not depend on which of its rows is rendered first: threads
  // share the rows, and pictures must not depend on how.
  void begin_band(int y) noexcept {
    const int node_row = map_.level(y).node_row;
    const int rows = map_.band_rows(node_row);
    const int begin = y / rows * rows;
    const int end = std::min(begin + rows, map_.size().height);
    int first = first_row(node_row, begin, y);
    int last = first_row(node_row + 1, y, end) - 1;
    // An uneven last row is a band of its own: its distance from the row before is a different one.
    const int even = map_.size().height - (map_.output_y().is_even() ? 0 : 1);
    y < even ? last = std::min(last, even - 1) : first = last;
    band_begin_ = first;
    band_end_ = last + 1;
    band_fraction_per_row_ = 1.0F / static_cast<float>(std::max(last - first, 1));
    // Where the camera model ends, rows have little in common.
    if (choice_.bicubic || map_.limits(y) != nullptr) {
      band_.clear();
      band_shared_ = false;
      return;
    }
    const PlaneMap::Level top = map_.level(first);
    const PlaneMap::Level bottom = map_.level(last);
    const PlaneMap::Level halfway = {node_row, (top.between + bottom.between) / 2};
    remap::interpolate_runs(nodes_at(top), runs_, band_.x_first, band_.y_first);
    remap::interpolate_runs(nodes_at(halfway), runs_, band_.x_halfway, band_.y_halfway);
    remap::interpolate_runs(nodes_at(bottom), runs_, band_.x_last, band_.y_last);
    const double height = bottom.between - top.between;
    band_shared_ = remap::begin_band(choice_.pixel_layout, pixels_, choice_.bounds, nodes_,
                                     node_row % 4, static_cast<float>(height), band_, row_);
  }

  // The first row, of those from `begin` to before `end`, whose level is at `node_row` or behind
  // it.
  [[nodiscard]] int first_row(int node_row, int begin, int end) const noexcept {
    while (begin < end) {
      const int middle = begin + (end - begin) / 2;
      map_.level(middle).node_row < node_row ? begin = middle + 1 : end = middle;
    }
    return begin;
  }

  // The nodes to interpolate a row from. Rows of nodes are expanded when first needed; of the four
  // slots each has the rows of nodes whose number modulo 4 is its own.
  remap::RowBetweenNodes nodes_at(const PlaneMap::Level& level) noexcept {
    constexpr int kBefore = remap::NodeRows::kFirst - remap::kMargin;
    const auto weights = cubic_weights(level.between);
    remap::RowBetweenNodes between = {nodes_, {}};
    for (int r = 0; r < 4; ++r) {
      const int wanted = level.node_row + r;
      const auto slot = static_cast<std::size_t>(wanted % 4);
      between.weights[slot] = weights[static_cast<std::size_t>(r)];
      if (known_[slot] == wanted) continue;
      map_.expand(wanted, first_run_, runs_ + 2 * remap::kMargin + remap::kSpare,
                  nodes_.x[slot] + kBefore, nodes_.y[slot] + kBefore);
      known_[slot] = wanted;
    }
    return between;
  }

  // Takes over the middles where the map's grid says nothing of them.
  void take_middles(const PlaneMap::Row& limits) noexcept {
    constexpr double kScale = 1 << remap::kCoordBits;
    constexpr double kMost = std::numeric_limits<std::int32_t>::max() / 4.0;
    for (const PlaneMap::Middle& middle : limits.middles) {
      const int at = middle.run - first_run_ + remap::kMargin;
      if (at < 0 || at >= runs_ + 2 * remap::kMargin) continue;
      row_.x[at] =
          static_cast<std::int32_t>(std::lrint(std::clamp(kScale * middle.coord.u, -kMost, kMost)));
      row_.y[at] =
          static_cast<std::int32_t>(std::lrint(std::clamp(kScale * middle.coord.v, -kMost, kMost)));
    }
  }

  // Marks as slow all groups of runs that are not valid from their first sample to their last.
  void mark_invalid(const PlaneMap::Row& limits) noexcept {
    const int pixels = group_ * pixels_;
    int done = 0;  // groups
    for (const PlaneMap::Span& span : limits.valid) {
      const int begin = std::max(span.begin - first_, 0);
      const int end = span.end - first_;
      const int whole = (begin + pixels - 1) / pixels;
      mark_slow(done * group_, std::min(whole * group_, row_.count));
      done = std::max(end / pixels, whole);
    }
    mark_slow(done * group_, row_.count);
  }

  void mark_slow(int begin, int end) noexcept {
    for (int j = std::max(begin, 0); j < end; ++j) row_.marks[j] = remap::kLeftOut;
  }

  [[nodiscard]] bool is_nearest() const noexcept {
    return sampling_.interpolation == Interpolation::kNearest;
  }

  [[nodiscard]] std::uint8_t* output_row(std::size_t plane, int y) const noexcept {
    return outputs_[plane].data + y * outputs_[plane].stride;
  }

  void blend(int y) noexcept {
    if (choice_.bicubic) return blend_bicubic(y);
    if (choice_.bounds.last_row < 0) return;
    const int whole = std::min(whole_groups_ * group_, row_.count);
    remap::PlaneRows planes{};
    planes.planes = static_cast<int>(sources_.size());
    for (std::size_t p = 0; p < sources_.size(); ++p) {
      planes.source[p] = sources_[p].data;
      planes.output[p] = output_at(p, y, 0);
    }
    blend(0, whole, planes);
    for (int j = whole; j < row_.count; j += group_) {
      if (!has(row_.marks[j], remap::RunMark::kSlowGroup)) blend_tail(y, j, planes);
    }
  }

  // Blends a group at the end of a row, which would write beyond the row, into memory beside it.
  void blend_tail(int y, int run, remap::PlaneRows planes) noexcept {
    const int pixels = std::min(map_.size().width - first_ - run * pixels_, group_ * pixels_);
    const auto bytes = static_cast<std::size_t>((pixels - 1) * layout_.pixel_step +
                                                (layout_.components - 1) * layout_.component_step +
                                                (is_words(choice_.pixel_layout) ? 2 : 1));
    std::array<std::array<std::uint8_t, kTail>, remap::kMaxPlanes> tails;
    for (std::size_t p = 0; p < sources_.size(); ++p) {
      std::memcpy(tails[p].data(), output_at(p, y, run), bytes);
      planes.output[p] = tails[p].data();
    }
    blend(run, run + group_, planes);
    for (std::size_t p = 0; p < sources_.size(); ++p) {
      std::memcpy(output_at(p, y, run), tails[p].data(), bytes);
    }
  }

  // Runs that the bicubic kernel leaves in one plane are left to the scalar kernel in all planes.
  void blend_bicubic(int y) noexcept {
    if (width_ % pixels_ != 0) mark_slow(row_.count - 1, row_.count);
    for (std::size_t p = 0; p < sources_.size(); ++p) {
      remap::blend_bicubic_runs(*choice_.bicubic, choice_.bounds, row_, sources_[p].data,
                                output_at(p, y, 0));
    }
  }

  void blend(int begin, int end, const remap::PlaneRows& planes) noexcept {
    blend_runs_({row_, band_, band_fraction_, choice_.bounds.stride, is_nearest(), words_}, begin,
                end, planes);
  }

  [[nodiscard]] std::uint8_t* output_at(std::size_t plane, int y, int run) const noexcept {
    return output_row(plane, y) + (first_ + run * pixels_) * layout_.pixel_step;
  }

  // Writes the slow runs: the fill, by the gather kernel, or by the scalar kernel.
  void sample_rest(int y, const PlaneMap::Row* limits, remap::SlowBlocks slow) noexcept {
    if (slow == 0) return;
    constexpr remap::RunMarks kKind = remap::RunMark::kSlow | remap::RunMark::kEmpty;
    const auto kind = [&](int j) { return row_.marks[j] & kKind; };
    const auto in_slow_block = [&](int j) { return (slow & remap::slow_block(j)) != 0; };
    // The gather kernel takes whole runs; the last run of a row may be shorter.
    const int whole = gathers(limits) ? width_ / pixels_ : 0;
    int gathered = 0;
    for (int j = 0, end = 0; j < row_.count; j = end) {
      if (!in_slow_block(j)) {
        end = (j / remap::kSlowBlockRuns + 1) * remap::kSlowBlockRuns;
        continue;
      }
      const remap::RunMarks of_first = kind(j);
      for (end = j + 1; end < row_.count && in_slow_block(end) && kind(end) == of_first; ++end) {
      }
      if (of_first == 0) continue;
      if (has(of_first, remap::RunMark::kEmpty)) {
        for (std::size_t p = 0; p < sources_.size(); ++p) {
          remap::fill_span(layout_, {output_row(p, y), 0}, span_of(j, end, limits));
        }
        continue;
      }
      for (; j < std::min(whole, end); ++j) scratch_.slow_runs[gathered++] = j;
      if (j < end) sample_span(y, j, end, limits);
    }
    for (std::size_t p = 0; p < sources_.size() && gathered > 0; ++p) gather(p, y, gathered);
  }

  // Whether the gather kernel takes slow runs.
  [[nodiscard]] bool gathers(const PlaneMap::Row* limits) const noexcept {
    return pixels_ == 8 && !choice_.bicubic && limits == nullptr && map_.output_x().is_even() &&
           choice_.bounds.last_row >= 0;
  }

  void gather(std::size_t plane, int y, int count) noexcept {
    const remap::GatherTask task = {row_,
                                    choice_.bounds.stride,
                                    choice_.x_ends,
                                    choice_.y_ends,
                                    is_nearest(),
                                    sampling_.outside == Outside::kFill,
                                    sampling_.outside == Outside::kMirror,
                                    fill_,
                                    words_};
    if (!remap::gather_runs(choice_.pixel_layout, task, scratch_.slow_runs.data(), count,
                            sources_[plane].data, output_at(plane, y, 0), scratch_.left.data())) {
      return;
    }
    for (int i = 0; i < count; ++i) {
      const int run = scratch_.slow_runs[i];
      if (scratch_.left[i]) sample_span(plane, y, span_of(run, run + 1, nullptr));
    }
  }

  [[nodiscard]] remap::RowSpan span_of(int begin, int end,
                                       const PlaneMap::Row* limits) const noexcept {
    return {row_, first_, begin * pixels_, std::min(end * pixels_, width_), limits};
  }

  void sample_span(int y, int begin, int end, const PlaneMap::Row* limits) noexcept {
    for (std::size_t p = 0; p < sources_.size(); ++p) {
      sample_span(p, y, span_of(begin, end, limits));
    }
  }
  void sample_span(std::size_t plane, int y, const remap::RowSpan& span) noexcept {
    remap::sample_span(map_, layout_, sources_[plane], {output_row(plane, y), 0}, sampling_, span);
  }

  // Bytes that a group writes at most: 4 runs of 8 pixels of four bytes, and the slack.
  static constexpr std::size_t kTail = 128 + 16;

  const PlaneMap& map_;
  const PlaneLayout& layout_;
  std::span<const PlaneMemory<const std::uint8_t>> sources_;
  std::span<const PlaneMemory<std::uint8_t>> outputs_;
  const Sampling& sampling_;
  remap::KernelChoice choice_;
  remap::DescribeRuns describe_runs_;
  remap::BlendRuns blend_runs_;
  remap::WordFormat words_;
  int group_;
  int pixels_;     // of a run
  int first_run_;  // of the plane
  int first_;      // sample of the plane
  int runs_ = 0;
  int width_ = 0;  // samples
  int whole_groups_ = 0;
  std::array<int, 4> known_ = {-1, -1, -1, -1};
  int band_begin_ = 0;
  int band_end_ = 0;
  bool band_shared_ = false;         // all runs of the band are steady or empty
  float band_fraction_per_row_ = 0;  // what each row adds to band_fraction_
  float band_fraction_ = 0;          // the fraction of the band's height above the row, 0..1
  std::uint32_t fill_ = 0;           // a filled pixel as it is in memory
  remap::RowScratch& scratch_;       // and its parts:
  NodeRows& nodes_;
  remap::Band& band_;
  RunRow& row_;
};

}  // namespace

void remap_rows(const PlaneMap& map, const PlaneLayout& layout,
                std::span<const PlaneMemory<const std::uint8_t>> sources,
                std::span<const PlaneMemory<std::uint8_t>> outputs, const Sampling& sampling,
                int begin, int end, remap::RowScratch& scratch) noexcept {
  if (layout.components < 1 || layout.components > 4 || sources.empty() ||
      sources.size() > remap::kMaxPlanes || sources.size() != outputs.size()) {
    return;
  }
  for (int first = 0; first < map.runs(); first += remap::kChunkRuns) {
    RowRenderer renderer(map, layout, sources, outputs, sampling, first, scratch);
    for (int y = begin; y < end; ++y) renderer.row(y);
  }
}

}  // namespace calvin
