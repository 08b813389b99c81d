// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/plane_map.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

namespace calvin {

PlaneMap::PlaneMap(std::shared_ptr<const RemapMap> map, const PlaneSites& sites, int run_pixels)
    : map_(std::move(map)),
      run_pixels_(run_pixels),
      out_x_(map_->output_size().width, sites.output.x_shift, sites.output.x_cosited),
      out_y_(map_->output_size().height, sites.output.y_shift, sites.output.y_cosited),
      in_x_(map_->source_size().width, sites.source.x_shift, sites.source.x_cosited),
      in_y_(map_->source_size().height, sites.source.y_shift, sites.source.y_cosited) {
  const int count = (out_x_.count() + run_pixels - 1) / run_pixels;
  for (int j = -remap::kMargin; j < count + remap::kMargin + remap::kSpare; ++j) {
    const double u = middle(j);
    const int column = map_->cell_of(u, map_->columns() - 3);
    runs_.push_back({column, cubic_weights(u / map_->step() - column)});
  }
}

double PlaneMap::middle(int run) const noexcept {
  return out_x_.offset() + out_x_.scale() * (run * run_pixels_ + (run_pixels_ - 1) / 2.0);
}

Pixel PlaneMap::to_samples(Pixel place) const noexcept {
  return {(place.u - in_x_.offset()) / in_x_.scale(), (place.v - in_y_.offset()) / in_y_.scale()};
}

std::size_t PlaneMap::bytes() const noexcept {
  std::size_t sum = runs_.size() * sizeof(Run) + rows_.size() * sizeof(Row);
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

void PlaneMap::expand(int node_row, int first, int count, float* x, float* y) const noexcept {
  const float* from_x = map_->x_row(node_row);
  const float* from_y = map_->y_row(node_row);
  const auto one = static_cast<float>(1 << remap::kPlaceBits);
  const float scale_x = one / static_cast<float>(in_x_.scale());
  const float scale_y = one / static_cast<float>(in_y_.scale());
  const float offset_x = scale_x * static_cast<float>(in_x_.offset());
  const float offset_y = scale_y * static_cast<float>(in_y_.offset());
  const int known = std::min(count, static_cast<int>(runs_.size()) - first);
  for (int j = 0; j < known; ++j) {
    const Run& run = runs_[static_cast<std::size_t>(first + j)];
    const auto& w = run.weights;
    const float* px = from_x + run.column;
    const float* py = from_y + run.column;
    x[j] = scale_x * (w[0] * px[0] + w[1] * px[1] + w[2] * px[2] + w[3] * px[3]) - offset_x;
    y[j] = scale_y * (w[0] * py[0] + w[1] * py[1] + w[2] * py[2] + w[3] * py[3]) - offset_y;
  }
  for (int j = std::max(known, 0); j < count; ++j) x[j] = y[j] = -one;
}

// Looks at the ends of runs, where parabolas are worst, in a part of the rows.
bool PlaneMap::follows_the_map() const {
  constexpr int kRows = 40;
  constexpr double kTolerance = 1.0 / 512;
  constexpr double kScale = 1.0 / (1 << remap::kPlaceBits);
  if (!strongly_bent()) return true;
  const double end = (run_pixels_ - 1) / 2.0;
  for (int i = 0; i <= kRows; ++i) {
    const double v = out_y_.site((out_y_.count() - 1) * i / kRows);
    const auto at = [&](double sample) {
      return to_samples(map_->at({out_x_.offset() + out_x_.scale() * sample, v}));
    };
    std::array<Pixel, 2 * remap::kMargin + 1> middles;
    for (int j = 0; j < runs() - 4; ++j) {
      for (std::size_t k = 0; k < middles.size(); ++k) {
        middles[k] = at((j + static_cast<int>(k)) * run_pixels_ + end);
      }
      const Pixel& place = middles[remap::kMargin];
      if (!(place.u > -1 && place.v > -1 && place.u < in_x_.count() && place.v < in_y_.count())) {
        continue;
      }
      std::array<std::int32_t, middles.size()> x;
      std::array<std::int32_t, middles.size()> y;
      for (std::size_t k = 0; k < middles.size(); ++k) {
        x[k] = static_cast<std::int32_t>(std::lrint(middles[k].u / kScale));
        y[k] = static_cast<std::int32_t>(std::lrint(middles[k].v / kScale));
      }
      const remap::RunParabola px(x.data(), run_pixels_);
      const remap::RunParabola py(y.data(), run_pixels_);
      for (const double t : {-end, end}) {
        const Pixel exact = at((j + remap::kMargin) * run_pixels_ + end + t);
        if (std::abs(px.at(t) - exact.u) > kTolerance ||
            std::abs(py.at(t) - exact.v) > kTolerance) {
          return false;
        }
      }
    }
  }
  return true;
}

std::vector<PlaneMap::Span> PlaneMap::valid_samples(int y, const PixelFunction& place_of) const {
  const double v = out_y_.site(y);
  const int cell_row = map_->cell_of(v, map_->rows() - 3);
  std::vector<Span> spans;
  int column = -1;
  auto kind = RemapMap::Cell::kSmooth;
  for (int i = 0; i < out_x_.count(); ++i) {
    const double u = out_x_.site(i);
    const int cell_column = map_->cell_of(u, map_->columns() - 3);
    if (cell_column != std::exchange(column, cell_column)) kind = map_->cell(column, cell_row);
    if (kind == RemapMap::Cell::kEmpty || (kind == RemapMap::Cell::kMixed && !place_of({u, v}))) {
      continue;
    }
    if (spans.empty() || spans.back().end != i) spans.push_back({i, i});
    spans.back().end = i + 1;
  }
  return spans;
}

// The middles of runs that valid samples need, and of the runs beside them. Where one of them is
// not valid itself the parabola through valid samples of the row goes on.
void PlaneMap::find_middles(int y, const PixelFunction& place_of, Row& row) const {
  const double v = out_y_.site(y);
  const int cell_row = map_->cell_of(v, map_->rows() - 3);
  const auto place_at = [&](double sample) {
    return place_of({out_x_.offset() + out_x_.scale() * sample, v});
  };
  int next = -remap::kMargin;  // the first run that is not yet decided on
  for (const Span& span : row.valid) {
    const int first = std::max(span.begin / run_pixels_ - remap::kMargin, next);
    const int last = (span.end - 1) / run_pixels_ + remap::kMargin;
    for (int run = first; run <= last; ++run) {
      const int column = map_->cell_of(middle(run), map_->columns() - 3);
      if (map_->cell(column, cell_row) == RemapMap::Cell::kSmooth) continue;
      const double wanted = run * run_pixels_ + (run_pixels_ - 1) / 2.0;
      std::optional<Pixel> place = place_at(wanted);
      if (!place) {
        const bool before = wanted < span.begin;
        const int base = before ? span.begin : span.end - 1;
        const int gap = std::min(4, (span.end - span.begin - 1) / 2) * (before ? 1 : -1);
        const auto a = place_at(base);
        const auto b = place_at(base + gap);
        const auto c = place_at(base + 2 * gap);
        if (!a || !b || !c) continue;
        const double t = gap == 0 ? 0 : (wanted - base) / gap;
        const auto onwards = [t](double p, double q, double r) {
          return p + t * (q - p) + t * (t - 1) / 2 * (r - 2 * q + p);
        };
        place = Pixel{onwards(a->u, b->u, c->u), onwards(a->v, b->v, c->v)};
      }
      row.middles.push_back({run, to_samples(*place)});
    }
    next = std::max(next, last + 1);
  }
}

Result<PlaneMap> PlaneMap::build(std::shared_ptr<const RemapMap> map, const PixelFunction& place_of,
                                 const PlaneSites& sites, int lane_pixels,
                                 const std::stop_token& stop) {
  try {
    PlaneMap plane(map, sites, 8);
    while (plane.run_pixels_ > 1 && !plane.follows_the_map()) {
      const bool first = plane.run_pixels_ > lane_pixels;
      plane = PlaneMap(map, sites, first ? lane_pixels : plane.run_pixels_ / 2);
    }
    if (plane.map_->everywhere_smooth()) return plane;
    plane.rows_.resize(static_cast<std::size_t>(plane.out_y_.count()));
    for (int y = 0; y < plane.out_y_.count(); ++y) {
      if (stop.stop_requested()) {
        return make_error(ErrorCode::kCancelled, "The work was cancelled.");
      }
      Row& row = plane.rows_[static_cast<std::size_t>(y)];
      row.valid = plane.valid_samples(y, place_of);
      plane.find_middles(y, place_of, row);
    }
    return plane;
  } catch (const std::bad_alloc&) {
    return make_error(ErrorCode::kInvalidArgument,
                      "There is not enough memory for a map of that size.");
  }
}

}  // namespace calvin
