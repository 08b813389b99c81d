// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A map as one plane of the frames sees it: by samples and by runs of samples.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "calvin/remap/map.hpp"
#include "calvin/remap/runs.hpp"
#include "calvin/remap/sampling.hpp"

namespace calvin {

// Immutable.
class PlaneMap {
 public:
  // Samples begin..end-1 of a row.
  struct Span {
    int begin = 0;
    int end = 0;
  };
  // The middle of a run where the map's grid says nothing of it, samples of the source.
  struct Middle {
    int run = 0;
    Pixel place;
  };
  // What a row that crosses the end of the model is made of.
  struct Row {
    std::vector<Span> valid;
    std::vector<Middle> middles;
  };

  // `place_of` is what the map was made of. Runs have 8 samples; where parabolas
  // would not follow the map, `lane_pixels`, which is what a kernel takes at a time, or fewer.
  // kCancelled soon after a stop was requested.
  static Result<PlaneMap> build(std::shared_ptr<const RemapMap> map, const PixelFunction& place_of,
                                const PlaneSites& sites, int lane_pixels,
                                const std::stop_token& stop = {});

  // In samples.
  [[nodiscard]] ImageSize size() const noexcept { return {out_x_.count(), out_y_.count()}; }
  [[nodiscard]] ImageSize source_size() const noexcept { return {in_x_.count(), in_y_.count()}; }
  // The centre of the source's last pixel, px.
  [[nodiscard]] Pixel source_last() const noexcept {
    return {map_->source_size().width - 1.0, map_->source_size().height - 1.0};
  }
  [[nodiscard]] const SampleAxis& source_x() const noexcept { return in_x_; }
  [[nodiscard]] const SampleAxis& source_y() const noexcept { return in_y_; }
  [[nodiscard]] const SampleAxis& output_x() const noexcept { return out_x_; }
  [[nodiscard]] const SampleAxis& output_y() const noexcept { return out_y_; }
  [[nodiscard]] int run_pixels() const noexcept { return run_pixels_; }
  [[nodiscard]] int runs() const noexcept {
    return static_cast<int>(columns_.size()) - 2 * remap::kMargin - remap::kSpare;
  }
  // Whether parabolas alone do not follow it, as runs of chroma, which are twice as long, or those
  // near the end of the model.
  [[nodiscard]] bool strongly_bent() const noexcept {
    return map_->step() < kStraight || out_x_.scale() > 1 || !map_->everywhere_smooth();
  }
  // Of this alone; the map is shared.
  [[nodiscard]] std::size_t bytes() const noexcept;

  // Between which node rows of the map a row lies: the first of four, and where between the second
  // and the third.
  struct Level {
    int node_row = 0;
    double between = 0;
  };
  [[nodiscard]] Level level(int y) const noexcept;

  // How many rows of those between the same node rows have slopes in common.
  [[nodiscard]] int band_rows(int node_row) const noexcept {
    return band_rows_[static_cast<std::size_t>(node_row)];
  }

  // The runs from first - kMargin on at a row of nodes; 1/2^14 of a sample of the source.
  void expand(int node_row, int first, int count, float* x, float* y) const noexcept;

  // nullptr: all of the row is valid and as the grid says. The end of the source picture is not
  // looked at.
  [[nodiscard]] const Row* limits(int y) const noexcept {
    return rows_.empty() ? nullptr : &rows_[static_cast<std::size_t>(y)];
  }

 private:
  PlaneMap(std::shared_ptr<const RemapMap> map, const PlaneSites& sites, int run_pixels);
  [[nodiscard]] double middle(int run) const noexcept;  // px of the output
  [[nodiscard]] Pixel to_samples(Pixel place) const noexcept;
  [[nodiscard]] double sway_at(int column, int node_row) const noexcept;
  [[nodiscard]] int count_band_rows(int node_row) const;
  // Of a row's runs.
  struct Bent {
    int all = 0;         // that show something of the source
    int on_the_map = 0;  // of these: those that a parabola does not follow
    int beyond = 0;      // likewise, where the map's grid says nothing of it
  };
  // As RunRow::x and y.
  struct Middles {
    std::vector<std::int32_t> x;
    std::vector<std::int32_t> y;
  };
  [[nodiscard]] bool follows_the_map(const PixelFunction& place_of) const;
  [[nodiscard]] Bent bent_runs(int y, const PixelFunction& place_of) const;
  [[nodiscard]] Middles middles_of(int y) const;
  [[nodiscard]] Span valid_part(int y, int run) const;
  [[nodiscard]] bool find_limits(const PixelFunction& place_of, const std::stop_token& stop);
  [[nodiscard]] std::vector<Span> valid_samples(int y, const PixelFunction& place_of) const;
  void find_middles(int y, const PixelFunction& place_of, Row& row) const;

  // Parabolas follow a map whose nodes may be this far apart, px.
  static constexpr int kStraight = 32;

  std::shared_ptr<const RemapMap> map_;
  int run_pixels_;
  SampleAxis out_x_;
  SampleAxis out_y_;
  SampleAxis in_x_;
  SampleAxis in_y_;
  // Of the runs and their margins, as remap::RunColumns.
  std::vector<std::int32_t> columns_;
  std::array<std::vector<float>, 3> weights_;
  std::vector<int> band_rows_;  // by node row
  std::vector<Row> rows_;
};

}  // namespace calvin
