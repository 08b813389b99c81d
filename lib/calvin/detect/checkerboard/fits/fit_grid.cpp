// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Polynomial surfaces through the bends of a board's edges.

#include "calvin/detect/checkerboard/fits/fit_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "calvin/detect/checkerboard/fits/lattice_surface.hpp"

namespace calvin::detect {

namespace {

// A row or a column of corners, and how it bends: from three nodes in a row at a time.
class Line {
 public:
  Line(const Lattice& lattice, const FitGrid& fits, Cell step)
      : lattice_(lattice), fits_(fits), step_(step) {}

  [[nodiscard]] bool is_row() const { return step_.row == 0; }
  // The unit vector to the side to which a positive bend goes.
  [[nodiscard]] Direction normal(Cell c) const {
    const SaddleFit& f = fits_.at(c);
    return is_row() ? Direction{-f.along.y, f.along.x} : Direction{f.down.y, -f.down.x};
  }
  [[nodiscard]] bool has_both(Cell c) const {
    return lattice_.has(c) && lattice_.has(c + step_) && lattice_.has(c - step_);
  }
  [[nodiscard]] bool has_any(Cell c) const {
    return lattice_.has(c) && (lattice_.has(c + step_) || lattice_.has(c - step_));
  }
  // The node itself, or at an end the inner neighbour: second differences of bends exist only
  // where both neighbours do.
  [[nodiscard]] Cell within(Cell c) const {
    if (has_both(c)) return c;
    if (has_both(c + step_)) return c + step_;
    return has_both(c - step_) ? c - step_ : c;
  }
  // The curvature at a node, 1/px: from its distance to the chord of both neighbours, or at an end
  // of the line from one neighbour and the direction of the edge in the node's own fit.
  [[nodiscard]] double bend(Cell c) const {
    double square = 0;
    double off = 0;
    const Direction side = normal(c);
    // Neighbours at different distances see an error of the edge's direction at the node alike.
    for (const Cell step : {step_, -1 * step_}) {
      if (!lattice_.has(c + step)) continue;
      const double share = 1 / length(c, step);
      const auto [u, v] = way(c, c + step);
      off += share * (static_cast<double>(side.x) * u + static_cast<double>(side.y) * v);
      square += share * (u * u + v * v);
    }
    return 2 * off / square;
  }
  // The variance of bend(c), 1/px^2.
  [[nodiscard]] double variance(Cell c) const {
    const SaddleFit& f = fits_.at(c);
    const auto sigma = static_cast<double>(f.sigma);
    const double square = square_to_next(c);
    if (has_both(c)) {
      // In mean steps, of which one is as long as the step to the next node says.
      const double ahead = length(c, step_);
      const double behind = length(c, -1 * step_);
      const double unit = square / (ahead * ahead) * (ahead + behind) / 2;
      const double sum = 1 / ahead + 1 / behind;
      const double squares = 1 / (ahead * ahead) + 1 / (behind * behind) + sum * sum;
      return squares * sigma * sigma / (unit * unit);
    }
    // The variance of a fitted direction is 3 sigma^2 / radius^2.
    const auto radius = static_cast<double>(f.radius);
    return sigma * sigma * (8 / square + 12 / (radius * radius)) / square;
  }
  // The place whose curvature bend(c) is: at an end the mean over the way to the neighbour, less
  // the part that the node's own window has taken into its direction.
  [[nodiscard]] LatticePlace place(Cell c) const {
    const LatticePlace at = lattice_.place(c);
    // Of three nodes that are not alike far apart the mean place.
    if (has_both(c)) return moved(at, step_, (length(c, step_) - length(c, -1 * step_)) / 3);
    const auto radius = static_cast<double>(fits_.at(c).radius);
    const double inwards = 1.0 / 3 - radius * radius / (5 * square_to_next(c));
    const Cell to = lattice_.has(c + step_) ? step_ : -1 * step_;
    return moved(at, to, inwards * length(c, to));
  }

 private:
  // Of a step from a node, in mean steps.
  [[nodiscard]] double length(Cell c, Cell step) const {
    return static_cast<double>(lattice_.length(c, step));
  }
  [[nodiscard]] std::pair<double, double> way(Cell c, Cell next) const {
    return {fits_.at(next).x - fits_.at(c).x, fits_.at(next).y - fits_.at(c).y};
  }
  [[nodiscard]] double square_to_next(Cell c) const {
    const auto [u, v] = way(c, lattice_.has(c + step_) ? c + step_ : c - step_);
    return u * u + v * v;
  }

  const Lattice& lattice_;
  const FitGrid& fits_;
  Cell step_;
};

// The error of a fitted place per bend of an edge that the fit took for straight, px^2. The place
// is off by the mean of u^2 / 2 over the part of the window in which the edge can be seen (u: way
// along the edge from the corner, px), and by the square of the blur over 2.
double error_per_bend(const SaddleFit& fit, bool of_row) {
  // Widths of the crossing edge within which the edge is not seen: the integral of 1 - e(x)^2 over
  // x > 0, which is 2 / sqrt(pi).
  constexpr double kDark = 1.13;
  constexpr double kLeastReach = 2;  // widths
  const auto radius = static_cast<double>(fit.radius);
  const auto width = static_cast<double>(of_row ? fit.down_width : fit.along_width);
  const double seen = std::max(radius - kDark * width, kLeastReach * width);
  return radius * radius * radius / (6 * seen) + 0.5 * width * width;
}

// Whether the bends at the ends of lines agree with the surface through the bends between them. The
// ends use directions of edges, which are wrong where a motion blur oblique to the edges turns
// them.
bool ends_agree(std::span<const PlacedValue> ends, const Surface<5>& between) {
  constexpr double kMost = 3;  // ratio of the mean square difference to its variance
  double sum = 0;
  for (const PlacedValue& end : ends) {
    const double off = end.value - between.at(end.at);
    sum += off * off * end.weight;
  }
  return sum <= kMost * between.variance() * static_cast<double>(ends.size());
}

// The bend with which windows of two sizes find a node at one place: the larger one depends on it
// more. Where squares are large this tells the bends at the ends of lines, at which neighbours do
// not; directions of edges would, too, but for light or ink that makes squares larger and turns
// them.
std::optional<PlacedValue> bend_of_both(const Lattice& lattice, const Line& line, Cell c,
                                        const SaddleFit& inner, const SaddleFit& outer) {
  if (!(inner.radius > 0) || inner.at_border || outer.at_border) return std::nullopt;
  const bool is_row = line.is_row();
  const double of_inner = error_per_bend(inner, is_row);
  const double of_outer = error_per_bend(outer, is_row);
  const auto bend = [&](const SaddleFit& fit) {
    return static_cast<double>(is_row ? fit.along_bend : fit.down_bend);
  };
  const Direction side = line.normal(c);
  const double apart = (inner.x - outer.x) * static_cast<double>(side.x) +
                       (inner.y - outer.y) * static_cast<double>(side.y);
  const double more = of_inner - of_outer;
  // The larger window has the pixels of the smaller one, so that their variances subtract.
  const auto square = [](float sigma) { return static_cast<double>(sigma * sigma); };
  constexpr double kLeast = 0.2;  // of the larger window's variance
  const double variance =
      std::max(square(inner.sigma) - square(outer.sigma), kLeast * square(outer.sigma));
  return PlacedValue{lattice.place(c),
                     (apart + of_inner * bend(inner) - of_outer * bend(outer)) / more,
                     more * more / variance};
}

// Sets the bends of all rows, or of all columns, to the values of the surface, and moves each fit
// to where a fit with that bend will find its corner. Returns the longest of these ways, px.
template <int kDegree>
double take_bends(const Lattice& lattice, Cell step, const Line& line,
                  const Surface<kDegree>& surface, FitGrid& fits) {
  // Three nodes give the mean of the bend over two squares, weighted by a triangle: off by 1/12 of
  // the second difference of the bends. A window reaches half as far and is off by a part of that.
  constexpr double kOfChange = 1.0 / 15;
  double most = 0;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const Cell inner = line.within(c);
    const LatticePlace within = lattice.place(inner);
    const double middle = surface.at(within);
    const double change =
        surface.at(moved(within, step, -1)) - 2 * middle + surface.at(moved(within, step, 1));
    const double here = inner == c ? middle : surface.at(lattice.place(c));
    const double bend = here - kOfChange * change;
    SaddleFit& f = fits.at(c);
    float& own = line.is_row() ? f.along_bend : f.down_bend;
    const double move = error_per_bend(f, line.is_row()) * (static_cast<double>(own) - bend);
    const Direction side = line.normal(c);
    f.x += move * static_cast<double>(side.x);
    f.y += move * static_cast<double>(side.y);
    own = static_cast<float>(bend);
    most = std::max(most, std::abs(move));
  });
  return most;
}

// Returns the longest way of a fit, px.
double set_bends_of(const Lattice& lattice, Cell step, FitGrid& fits) {
  // The fewest nodes of a line for a surface of the fifth degree: from fewer, its error grows
  // without bound towards the ends of the line.
  constexpr int kLong = 6;
  const Line line(lattice, fits, step);
  // Nodes between others first, the ends of lines after them.
  std::vector<PlacedValue> bends;
  const Surface<5> none = flat<5>(lattice);
  Surface<5> all = none;
  const auto add = [&](Cell c) {
    bends.push_back({line.place(c), line.bend(c), 1 / line.variance(c)});
    all.add(bends.back());
  };
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (line.has_both(c)) add(c);
  });
  const std::size_t between = bends.size();
  const CellRange extent = lattice.extent();
  if ((line.is_row() ? extent.cols() : extent.rows()) < kLong) {
    const auto plain = surface_over<2>(lattice, bends, 1);
    return take_bends(lattice, step, line, plain, fits);
  }
  auto surface = surface_through(none, all, bends, 1);
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (line.has_any(c) && !line.has_both(c)) add(c);
  });
  if (ends_agree(std::span(bends).subspan(between), surface)) {
    surface = surface_through(none, all, bends, 1);
  }
  return take_bends(lattice, step, line, surface, fits);
}

// set_bends_of() with what windows of two sizes tell. Returns the bends.
Surface<5> correct_bends_of(const Lattice& lattice, Cell step, const FitGrid& inner,
                            FitGrid& fits) {
  const Line line(lattice, fits, step);
  std::vector<PlacedValue> bends;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (line.has_both(c)) bends.push_back({line.place(c), line.bend(c), 1 / line.variance(c)});
    const auto both = bend_of_both(lattice, line, c, inner.at(c), fits.at(c));
    if (both) bends.push_back(*both);
  });
  const auto surface = surface_over<5>(lattice, bends, 1);
  std::ignore = take_bends(lattice, step, line, surface, fits);
  return surface;
}

}  // namespace

void FitGrid::include(Cell c) {
  if (has(c)) return;
  CellRange all = cells_;
  all.first = {std::min(all.first.col, c.col), std::min(all.first.row, c.row)};
  all.last = {std::max(all.last.col, c.col), std::max(all.last.row, c.row)};
  FitGrid larger;
  larger.reset(all);
  for (int row = cells_.first.row; row <= cells_.last.row; ++row) {
    for (int col = cells_.first.col; col <= cells_.last.col; ++col) {
      larger.at({col, row}) = at({col, row});
    }
  }
  cells_ = all;
  fits_ = std::move(larger.fits_);
}

void set_bends(const Lattice& lattice, FitGrid& fits) {
  // The first fits took edges for straight and are off, and so are the bends computed from them: a
  // second round starts from places that the first has corrected, where it has moved any by so much
  // that bends, which are differences of neighbours, change.
  constexpr double kFar = 0.03;  // px
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    const double along = set_bends_of(lattice, {1, 0}, fits);
    const double down = set_bends_of(lattice, {0, 1}, fits);
    if (std::max(along, down) < kFar) return;
  }
}

bool are_bent(const Lattice& lattice, const FitGrid& fits) {
  constexpr double kBent = 0.03;  // px, by which a bend moves a corner: a tenth of it is little
  bool bent = false;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const SaddleFit& f = fits.at(c);
    const double most =
        std::max(error_per_bend(f, true) * std::abs(static_cast<double>(f.along_bend)),
                 error_per_bend(f, false) * std::abs(static_cast<double>(f.down_bend)));
    bent = bent || most > kBent;
  });
  return bent;
}

void correct_bends(const Lattice& lattice, const FitGrid& inner, FitGrid& fits) {
  const Surface<5> of_rows = correct_bends_of(lattice, {1, 0}, inner, fits);
  const Surface<5> of_columns = correct_bends_of(lattice, {0, 1}, inner, fits);
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    SaddleFit& f = fits.at(c);
    const LatticePlace at = lattice.place(c);
    const double by_row = error_per_bend(f, true);
    const double by_column = error_per_bend(f, false);
    // Each edge tells of one of the two coordinates.
    const double variance = 0.5 * (by_row * by_row * of_rows.variance_at(at) +
                                   by_column * by_column * of_columns.variance_at(at));
    f.sigma = std::hypot(f.sigma, static_cast<float>(std::sqrt(variance)));
  });
}

void widen_ends(const Lattice& lattice, FitGrid& fits) {
  // Beside what a bend at the end of a line differs by from the next one, measured on rendered
  // boards that borders cut off.
  constexpr double kUncertain = 0.2;
  const auto bend = [&](Cell c, Cell line) {
    const SaddleFit& f = fits.at(c);
    return static_cast<double>(line.row == 0 ? f.along_bend : f.down_bend);
  };
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    SaddleFit& f = fits.at(c);
    for (const Cell line : {Cell{1, 0}, Cell{0, 1}}) {
      if (lattice.has(c + line) && lattice.has(c - line)) continue;
      const Cell aside = {line.row, line.col};
      for (const Cell step : {line, -1 * line, aside, -1 * aside}) {
        if (!lattice.has(c + step)) continue;
        // The edge tells of one of the two coordinates.
        const double off = std::numbers::sqrt2 / 2 * kUncertain *
                           (bend(c, line) - bend(c + step, line)) *
                           error_per_bend(f, line.row == 0);
        f.sigma = std::hypot(f.sigma, static_cast<float>(off));
        break;
      }
    }
  });
}

}  // namespace calvin::detect
