// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A map as one plane of the frames sees it: in samples of the plane, as runs and bands.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "calvin/remap/map/map.hpp"
#include "calvin/remap/map/runs.hpp"
#include "calvin/remap/map/sampling.hpp"

namespace calvin {

// Immutable.
class PlaneMap {
 public:
  // The samples begin..end-1 of a row.
  struct Span {
    int begin = 0;
    int end = 0;
  };
  // The middle of a run, samples of the source, where the map's grid does not tell it.
  struct Middle {
    int run = 0;
    Pixel coord;
  };
  // A row that crosses the end of the camera model: which of its samples are valid, and the middles
  // that the grid does not tell.
  struct Row {
    std::vector<Span> valid;
    std::vector<Middle> middles;
  };

  // `source_of` is the function that the map was made of. Runs have eight samples; where parabolas
  // would not follow the map, they have `pixels_per_lane`, the samples of a vector kernel's lane,
  // or fewer. kCancelled soon after a stop was requested.
  static Result<PlaneMap> build(std::shared_ptr<const RemapMap> map, const PixelFunction& source_of,
                                const PlaneSites& sites, int pixels_per_lane,
                                const std::stop_token& stop = {});

  // Sizes of the planes, samples.
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
  // Whether third differences of the middles count: in fine maps, for chroma, whose runs are twice
  // as long, and where the model ends.
  [[nodiscard]] bool strongly_bent() const noexcept {
    return map_->step() < kStraight || out_x_.scale() > 1 || !map_->everywhere_smooth();
  }
  // The memory of this plane map; the map that it shares is not counted.
  [[nodiscard]] std::size_t bytes() const noexcept;

  // Where a row lies between the map's rows of nodes: the first of the four to interpolate from,
  // and the fraction of the way from the second to the third.
  struct Level {
    int node_row = 0;
    double between = 0;
  };
  [[nodiscard]] Level level(int y) const noexcept;

  // The height of the bands between the same two rows of nodes, rows of the output.
  [[nodiscard]] int band_rows(int node_row) const noexcept {
    return band_rows_[static_cast<std::size_t>(node_row)];
  }

  // Writes the middles of `count` runs at a row of nodes, from the run first - kMargin on, in
  // 1/2^14 of a sample of the source.
  void expand(int node_row, int first, int count, float* x, float* y) const noexcept;

  // nullptr: all samples of the row are valid, and the grid tells all middles. Whether they are
  // within the source picture is another matter.
  [[nodiscard]] const Row* limits(int y) const noexcept {
    return rows_.empty() ? nullptr : &rows_[static_cast<std::size_t>(y)];
  }

 private:
  PlaneMap(std::shared_ptr<const RemapMap> map, const PlaneSites& sites, int run_pixels);
  [[nodiscard]] double middle(int run) const noexcept;  // px of the output
  [[nodiscard]] Pixel to_samples(Pixel coord) const noexcept;
  [[nodiscard]] double deviation_at(int column, int node_row) const noexcept;
  [[nodiscard]] int count_band_rows(int node_row) const;
  // Counts of the runs of a row.
  struct Bent {
    int all = 0;         // runs that show something of the source
    int on_the_map = 0;  // of these: runs that a parabola does not follow
    int beyond = 0;      // likewise, where the map's grid does not tell the coordinates
  };
  // The middles of a row, as RunRow::x and y.
  struct Middles {
    std::vector<std::int32_t> x;
    std::vector<std::int32_t> y;
  };
  [[nodiscard]] bool follows_the_map(const PixelFunction& source_of) const;
  [[nodiscard]] Bent bent_runs(int y, const PixelFunction& source_of) const;
  [[nodiscard]] Middles middles_of(int y) const;
  [[nodiscard]] Span valid_part(int y, int run) const;
  [[nodiscard]] bool find_limits(const PixelFunction& source_of, const std::stop_token& stop);
  [[nodiscard]] std::vector<Span> valid_samples(int y, const PixelFunction& source_of) const;
  void find_middles(int y, const PixelFunction& source_of, Row& row) const;

  // The distance of nodes, px, from which on parabolas follow the map everywhere.
  static constexpr int kStraight = 32;

  std::shared_ptr<const RemapMap> map_;
  int run_pixels_;
  SampleAxis out_x_;
  SampleAxis out_y_;
  SampleAxis in_x_;
  SampleAxis in_y_;
  // As remap::RunColumns, of the runs and their margins.
  std::vector<std::int32_t> columns_;
  std::array<std::vector<float>, 3> weights_;
  std::vector<int> band_rows_;  // by node row
  std::vector<Row> rows_;
};

}  // namespace calvin
