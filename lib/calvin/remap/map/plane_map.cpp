// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cuts the rows of a plane into runs: how long they have to be, how high bands may be, and where
// the camera model ends.

#include "calvin/remap/map/plane_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "calvin/remap/map/run_middles.hpp"

namespace calvin {

namespace {

// One in so many columns of cells may deviate too much for the height of a band; where there are
// more, bands of half the height cost less than runs that are not steady.
constexpr int kMaxBentPart = 16;

// Coordinates are clamped to this distance from the origin, samples: so that they fit into 32 bits
// in 1/2^14 of a sample. What is farther off is not seen anyway.
constexpr double kFarFromOrigin = 1e5;

}  // namespace

PlaneMap::PlaneMap(std::shared_ptr<const RemapMap> map, const PlaneSites& sites, int run_pixels)
    : map_(std::move(map)),
      run_pixels_(run_pixels),
      out_x_(map_->output_size().width, sites.output.x_shift, sites.output.x_cosited,
             sites.output.x_before),
      out_y_(map_->output_size().height, sites.output.y_shift, sites.output.y_cosited,
             sites.output.y_before),
      in_x_(map_->source_size().width, sites.source.x_shift, sites.source.x_cosited,
            sites.source.x_before),
      in_y_(map_->source_size().height, sites.source.y_shift, sites.source.y_cosited,
            sites.source.y_before) {
  const int count = (out_x_.count() + run_pixels - 1) / run_pixels;
  for (int j = -remap::kMargin; j < count + remap::kMargin + remap::kSpare; ++j) {
    const double u = middle(j);
    const int column = map_->cell_of(u, map_->columns() - 3);
    const auto weights = cubic_weights(u / map_->step() - column);
    columns_.push_back(column);
    weights_[0].push_back(weights[0]);
    weights_[1].push_back(weights[2]);
    weights_[2].push_back(weights[3]);
  }
  for (int row = 0; row + 3 < map_->rows(); ++row) band_rows_.push_back(count_band_rows(row));
}

double PlaneMap::middle(int run) const noexcept {
  return out_x_.offset() + out_x_.scale() * (run * run_pixels_ + (run_pixels_ - 1) / 2.0);
}

Pixel PlaneMap::to_samples(Pixel coord) const noexcept {
  return {(coord.u - in_x_.offset()) / in_x_.scale(), (coord.v - in_y_.offset()) / in_y_.scale()};
}

std::size_t PlaneMap::bytes() const noexcept {
  std::size_t sum = columns_.size() * 4 * sizeof(float) + band_rows_.size() * sizeof(int) +
                    rows_.size() * sizeof(Row);
  for (const Row& row : rows_) {
    sum += row.valid.size() * sizeof(Span) + row.middles.size() * sizeof(Middle);
  }
  return sum;
}

PlaneMap::Level PlaneMap::level(int y) const noexcept {
  const double v = out_y_.site(y);
  const int row = map_->cell_of(v, map_->rows() - 3);
  return {row, v / map_->step() - row};
}

// How far the distance between a run's two neighbours deviates, in the middle of a cell, from a
// line down the cell: as kMaxDeviation, for a band as high as the cell. 0 where the cell shows
// nothing of the source.
double PlaneMap::deviation_at(int column, int node_row) const noexcept {
  if (!map_->matters(column - 1, node_row)) return 0;
  // The largest change of the second difference down the nodes, from a column to the next but one.
  const auto change = [&](auto nodes) {
    double largest = 0;
    for (const int row : {node_row + 1, node_row + 2}) {
      const auto bow = [&](int c) {
        return nodes(row - 1)[c] - 2.0 * nodes(row)[c] + nodes(row + 1)[c];
      };
      largest = std::max(largest, std::abs(bow(column + 1) - bow(column - 1)));
    }
    return largest;
  };
  // The neighbours are two runs apart and the columns two steps: run / step. In the middle, a
  // parabola is 1/8 of its second difference off its chord, and kMaxDeviation counts it twice: 1/4.
  const double part = run_pixels_ * out_x_.scale() / map_->step() / 4;
  return (1 << remap::kCoordBits) * part *
         std::max(change([&](int row) { return map_->x_row(row); }) / in_x_.scale(),
                  change([&](int row) { return map_->y_row(row); }) / in_y_.scale());
}

// The largest height of bands at which most columns stay within kMaxDeviation; the deviation grows
// with the square of the height.
int PlaneMap::count_band_rows(int node_row) const {
  std::vector<double> deviations;
  for (int c = 1; c + 2 < map_->columns(); ++c) deviations.push_back(deviation_at(c, node_row));
  int rows = remap::kBandRows;
  for (; rows > remap::kFewestBandRows; rows /= 2) {
    const double part = std::min(rows * out_y_.scale() / map_->step(), 1.0);
    const auto is_bent = [&](double deviation) {
      return deviation * part * part > remap::kMaxDeviation;
    };
    const auto bent = std::count_if(deviations.begin(), deviations.end(), is_bent);
    if (bent * kMaxBentPart <= map_->columns()) break;
  }
  return rows;
}

void PlaneMap::expand(int node_row, int first, int count, float* x, float* y) const noexcept {
  const auto line = [this](const float* nodes, const SampleAxis& axis) {
    const auto one = static_cast<float>(1 << remap::kCoordBits);
    const float scale = one / static_cast<float>(axis.scale());
    return remap::NodeLine{nodes, map_->columns(), scale,
                           scale * static_cast<float>(axis.offset())};
  };
  const remap::RunColumns runs = {columns_.data(),
                                  {weights_[0].data(), weights_[1].data(), weights_[2].data()}};
  const int known = std::clamp(static_cast<int>(columns_.size()) - first, 0, count);
  remap::expand_runs(runs, first, known, line(map_->x_row(node_row), in_x_), x);
  remap::expand_runs(runs, first, known, line(map_->y_row(node_row), in_y_), y);
  std::fill(x + known, x + count, -1.0F);
  std::fill(y + known, y + count, -1.0F);
}

// Whether the parabolas of runs are within the tolerance: at the ends of the runs, where parabolas
// are worst, in 21 of the rows.
bool PlaneMap::follows_the_map(const PixelFunction& source_of) const {
  constexpr int kRows = 20;
  if (!strongly_bent()) return true;
  Bent sum;
  for (int i = 0; i <= kRows; ++i) {
    const Bent row = bent_runs((out_y_.count() - 1) * i / kRows, source_of);
    if (row.on_the_map > 0) return false;
    sum.beyond += row.beyond;
    sum.all += row.all;
  }
  // Where the model ends, a map may be bent at will: 1 in 500 runs may be wrong there, rather than
  // all others be shorter and slower.
  return sum.beyond * 500 <= sum.all;
}

// Counts the runs of row `y` whose parabolas are not within the tolerance.
PlaneMap::Bent PlaneMap::bent_runs(int y, const PixelFunction& source_of) const {
  const double tolerance = map_->tolerance();
  const Middles middles = middles_of(y);
  Bent bent;
  for (int run = 0; run < runs(); ++run) {
    const remap::RunParabola px(&middles.x[static_cast<std::size_t>(run)], run_pixels_);
    const remap::RunParabola py(&middles.y[static_cast<std::size_t>(run)], run_pixels_);
    const Span valid = valid_part(y, run);
    const bool shows = valid.begin < valid.end && px.middle > -1 && py.middle > -1 &&
                       px.middle < in_x_.count() && py.middle < in_y_.count();
    if (!shows) continue;
    ++bent.all;
    bool of_map = true;
    const auto follows = [&](int sample) {
      const double t = sample - run * run_pixels_ - (run_pixels_ - 1) / 2.0;
      const Pixel at = {middle(run) + out_x_.scale() * t, out_y_.site(y)};
      Pixel exact = map_->at(at);
      if (!std::isfinite(exact.u) || !std::isfinite(exact.v)) {
        of_map = false;
        exact = source_of(at).value_or(Pixel{kFarFromOrigin, kFarFromOrigin});
      }
      const Pixel coord = to_samples(exact);
      return std::abs(px.at(t) - coord.u) <= tolerance && std::abs(py.at(t) - coord.v) <= tolerance;
    };
    const bool both = follows(valid.begin) && follows(valid.end - 1);
    if (!both) ++(of_map ? bent.on_the_map : bent.beyond);
  }
  return bent;
}

// The middles of a row, margins included, as the kernels have them.
PlaneMap::Middles PlaneMap::middles_of(int y) const {
  constexpr double kScale = 1 << remap::kCoordBits;
  const auto number = [&](double coord) {
    return static_cast<std::int32_t>(
        std::lrint(std::clamp(coord, -kFarFromOrigin, kFarFromOrigin) * kScale));
  };
  Middles middles;
  for (int j = -remap::kMargin; j < runs() + remap::kMargin; ++j) {
    const Pixel coord = to_samples(map_->at({middle(j), out_y_.site(y)}));
    const bool known = std::isfinite(coord.u) && std::isfinite(coord.v);
    middles.x.push_back(known ? number(coord.u) : 0);
    middles.y.push_back(known ? number(coord.v) : 0);
  }
  if (const Row* row = limits(y)) {
    for (const Middle& found : row->middles) {
      const auto j = static_cast<std::size_t>(found.run + remap::kMargin);
      if (j >= middles.x.size()) continue;
      middles.x[j] = number(found.coord.u);
      middles.y[j] = number(found.coord.v);
    }
  }
  return middles;
}

// The samples of a run from the first valid one to the last.
PlaneMap::Span PlaneMap::valid_part(int y, int run) const {
  const Span all = {run * run_pixels_, std::min((run + 1) * run_pixels_, out_x_.count())};
  const Row* row = limits(y);
  if (row == nullptr) return all;
  Span part = {all.end, all.begin};
  for (const Span& span : row->valid) {
    if (span.end <= all.begin || span.begin >= all.end) continue;
    part.begin = std::min(part.begin, std::max(span.begin, all.begin));
    part.end = std::max(part.end, std::min(span.end, all.end));
  }
  return part;
}

// The samples of a row that the camera model tells source coordinates for.
std::vector<PlaneMap::Span> PlaneMap::valid_samples(int y, const PixelFunction& source_of) const {
  const double v = out_y_.site(y);
  const int cell_row = map_->cell_of(v, map_->rows() - 3);
  std::vector<Span> spans;
  int column = -1;
  auto kind = RemapMap::Cell::kSmooth;
  for (int i = 0; i < out_x_.count(); ++i) {
    const double u = out_x_.site(i);
    const int cell_column = map_->cell_of(u, map_->columns() - 3);
    if (cell_column != std::exchange(column, cell_column)) kind = map_->cell(column, cell_row);
    if (kind == RemapMap::Cell::kEmpty || (kind == RemapMap::Cell::kMixed && !source_of({u, v}))) {
      continue;
    }
    if (spans.empty() || spans.back().end != i) spans.push_back({i, i});
    spans.back().end = i + 1;
  }
  return spans;
}

// Finds the middles of runs with valid samples, and of the runs beside them. Where a middle is not
// valid itself, a parabola through three valid samples of the row is continued to it.
void PlaneMap::find_middles(int y, const PixelFunction& source_of, Row& row) const {
  const double v = out_y_.site(y);
  const int cell_row = map_->cell_of(v, map_->rows() - 3);
  const auto source_at = [&](double sample) {
    return source_of({out_x_.offset() + out_x_.scale() * sample, v});
  };
  int next = -remap::kMargin;  // the first run that is not yet decided on
  for (const Span& span : row.valid) {
    const int first = std::max(span.begin / run_pixels_ - remap::kMargin, next);
    const int last = (span.end - 1) / run_pixels_ + remap::kMargin;
    for (int run = first; run <= last; ++run) {
      const int column = map_->cell_of(middle(run), map_->columns() - 3);
      if (map_->cell(column, cell_row) == RemapMap::Cell::kSmooth) continue;
      const double wanted = run * run_pixels_ + (run_pixels_ - 1) / 2.0;
      std::optional<Pixel> coord = source_at(wanted);
      if (!coord) {
        const bool before = wanted < span.begin;
        const int base = before ? span.begin : span.end - 1;
        const int gap = std::min(4, (span.end - span.begin - 1) / 2) * (before ? 1 : -1);
        const auto a = source_at(base);
        const auto b = source_at(base + gap);
        const auto c = source_at(base + 2 * gap);
        if (!a || !b || !c) continue;
        const double t = gap == 0 ? 0 : (wanted - base) / gap;
        const auto onwards = [t](double p, double q, double r) {
          return p + t * (q - p) + t * (t - 1) / 2 * (r - 2 * q + p);
        };
        coord = Pixel{onwards(a->u, b->u, c->u), onwards(a->v, b->v, c->v)};
      }
      row.middles.push_back({run, to_samples(*coord)});
    }
    next = std::max(next, last + 1);
  }
}

// Finds limits() of all rows. Returns false where a stop was requested.
bool PlaneMap::find_limits(const PixelFunction& source_of, const std::stop_token& stop) {
  if (map_->everywhere_smooth()) return true;
  const bool known = !rows_.empty();
  rows_.resize(static_cast<std::size_t>(out_y_.count()));
  for (int y = 0; y < out_y_.count(); ++y) {
    if (stop.stop_requested()) return false;
    Row& row = rows_[static_cast<std::size_t>(y)];
    if (!known) row.valid = valid_samples(y, source_of);
    row.middles.clear();
    find_middles(y, source_of, row);
  }
  return true;
}

Result<PlaneMap> PlaneMap::build(std::shared_ptr<const RemapMap> map,
                                 const PixelFunction& source_of, const PlaneSites& sites,
                                 int pixels_per_lane, const std::stop_token& stop) {
  try {
    PlaneMap plane(map, sites, 8);
    while (plane.find_limits(source_of, stop)) {
      const int pixels = plane.run_pixels_;
      if (pixels == 1 || plane.follows_the_map(source_of)) return plane;
      std::vector<Row> rows = std::move(plane.rows_);
      plane = PlaneMap(map, sites, pixels > pixels_per_lane ? pixels_per_lane : pixels / 2);
      plane.rows_ = std::move(rows);
    }
    return make_error(ErrorCode::kCancelled, "The work was cancelled.");
  } catch (const std::bad_alloc&) {
    return make_error(ErrorCode::kInvalidArgument,
                      "There is not enough memory for a map of that size.");
  }
}

}  // namespace calvin
