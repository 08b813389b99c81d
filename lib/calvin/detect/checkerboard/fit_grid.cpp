// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Polynomial surfaces through the fits of a board: the bends of its edges, the fall of light.

#include "calvin/detect/checkerboard/fit_grid.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Core>

namespace calvin::detect {

namespace {

// A place so many mean steps along the way of a step, or behind.
LatticePlace moved(const LatticePlace& from, Cell step, double by) {
  return {from.col + by * step.col, from.row + by * step.row};
}

// A polynomial of degree kDegree over the places of a lattice, fitted by weighted least squares.
template <int kDegree>
class Surface {
 public:
  static constexpr int terms_of(int degree) { return (degree + 1) * (degree + 2) / 2; }
  static constexpr int kTerms = terms_of(kDegree);
  using Terms = Eigen::Matrix<double, kTerms, 1>;

  // Over the places from one to another.
  Surface(const LatticePlace& first, const LatticePlace& last)
      : middle_col_(0.5 * (first.col + last.col)),
        middle_row_(0.5 * (first.row + last.row)),
        half_cols_(std::max(0.5 * (last.col - first.col), 1.0)),
        half_rows_(std::max(0.5 * (last.row - first.row), 1.0)) {}

  // The monomials at a place, those of a lower degree first, in coordinates that run from -1 to 1
  // over the lattice.
  [[nodiscard]] Terms terms(const LatticePlace& s) const {
    const double x = (s.col - middle_col_) / half_cols_;
    const double y = (s.row - middle_row_) / half_rows_;
    Terms t;
    t[0] = 1;
    int before = 0;  // index of the first term of the degree below
    int k = 1;
    for (int degree = 1; degree <= kDegree; before += degree++) {
      for (int i = 0; i < degree; ++i) t[k++] = x * t[before + i];
      t[k++] = y * t[before + degree - 1];
    }
    return t;
  }
  // `weight` is 1 / variance of the value, up to a factor that all values share.
  void add(const LatticePlace& s, double value, double weight) {
    const Terms t = terms(s);
    normal_.template selfadjointView<Eigen::Lower>().rankUpdate(t, weight);
    right_ += weight * value * t;
    square_ += weight * value * value;
    ++count_;
  }
  // Finds the coefficients; without values all are 0. `variance` is the least variance of a value
  // of weight 1. Orthonormal terms have that variance each: from the third degree on, the terms of
  // a degree are left out together where their mean square is not kClearly times the variance,
  // because noise in high terms is largest at the border of the lattice. Terms that stay are shrunk
  // by the share of noise in their square (James and Stein, Estimation with Quadratic Loss, 1961).
  void solve(double variance) {
    constexpr int kFirst = 3;       // lowest degree in doubt
    constexpr double kClearly = 3;  // ratio of variances; noise alone exceeds it once in 60 times
    orthogonalise();
    variance = std::max(variance, measured(variance));
    variance_ = variance;
    for (int degree = kFirst; degree <= kDegree; ++degree) {
      const int first = terms_of(degree - 1);
      auto block = right_.segment(first, terms_of(degree) - first);
      const double square = block.squaredNorm();
      const double noise = variance * static_cast<double>((block.array() != 0).count());
      block *= square > kClearly * noise ? 1 - noise / square : 0;
    }
    for (int k = kTerms - 1; k >= 0; --k) {
      const int rest = kTerms - 1 - k;
      const double others = normal_.col(k).tail(rest).dot(coefficients_.tail(rest));
      coefficients_[k] = normal_(k, k) > 0 ? (right_[k] - others) / normal_(k, k) : 0;
    }
  }
  [[nodiscard]] double at(const LatticePlace& s) const { return terms(s).dot(coefficients_); }
  // The variance of a value of weight 1, measured by the residuals.
  [[nodiscard]] double variance() const { return variance_; }

 private:
  // Replaces the normal matrix by its Cholesky factor, and the right side by the coefficients of
  // terms that are orthonormal over the data: each coefficient has the variance of one value. A
  // term that depends linearly on the terms before it gets the coefficient 0.
  void orthogonalise() {
    constexpr double kNew = 1e-3;  // share of a term's square that the terms before do not explain
    const Terms squares = normal_.diagonal();
    for (int k = 0; k < kTerms; ++k) {
      const bool is_new = normal_(k, k) > kNew * squares[k];
      const double length = std::sqrt(normal_(k, k));
      auto column = normal_.col(k).tail(kTerms - k);
      if (is_new) {
        column /= length;
        right_[k] /= length;
      } else {
        column.setZero();
        right_[k] = 0;
      }
      for (int next = k + 1; next < kTerms; ++next) {
        normal_.col(next).tail(kTerms - next) -=
            normal_(next, k) * normal_.col(k).tail(kTerms - next);
        right_[next] -= normal_(next, k) * right_[k];
      }
    }
  }

  // The variance of the residuals of all terms together, averaged with kPresumed values of the
  // variance `presumed`: a compressed picture has more noise than single windows show.
  [[nodiscard]] double measured(double presumed) const {
    constexpr double kPresumed = 4;  // values
    const double left = std::max(square_ - right_.squaredNorm(), 0.0);
    const auto terms = static_cast<double>((right_.array() != 0).count());
    return (left + kPresumed * presumed) / (std::max(count_ - terms, 0.0) + kPresumed);
  }

  double middle_col_;
  double middle_row_;
  double half_cols_;
  double half_rows_;
  Eigen::Matrix<double, kTerms, kTerms> normal_ = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Terms right_ = Terms::Zero();
  Terms coefficients_ = Terms::Zero();
  double square_ = 0;  // of the values, weighted
  double count_ = 0;
  double variance_ = 0;
};

// The surface through the numbers of the nodes for which has(cell). Nodes that stand out from a
// first surface are left out, because something may lie over a part of the board. place(cell) is
// the place that a number belongs to; weight(cell) and `variance` are those of Surface.
template <int kDegree, typename H, typename S, typename W>
Surface<kDegree> surface_of(const Lattice& lattice, FitGrid& fits, H has, S place, W weight,
                            double variance) {
  constexpr float kOut = 5;  // times the median distance from the first surface
  const auto through = [&](auto is_in) {
    const CellRange extent = lattice.extent();
    Surface<kDegree> surface(lattice.place(extent.first), lattice.place(extent.last));
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      if (is_in(c)) surface.add(place(c), static_cast<double>(fits.number(c)), weight(c));
    });
    surface.solve(variance);
    return surface;
  };
  const Surface<kDegree> all = through(has);
  const auto off = [&](Cell c) {
    return std::abs(fits.number(c) - static_cast<float>(all.at(place(c))));
  };
  const float most = kOut * fits.median_where(lattice, has, off);
  const auto is_in = [&](Cell c) { return has(c) && off(c) <= most; };
  bool none = true;
  lattice.for_each([&](Cell c, const Node& /*node*/) { none = none && has(c) == is_in(c); });
  return none ? all : through(is_in);
}

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
double error_per_bend(const SaddleFit& fit, float width_along) {
  // Widths of the crossing edge within which the edge is not seen: the integral of 1 - e(x)^2 over
  // x > 0, which is 2 / sqrt(pi).
  constexpr double kDark = 1.13;
  constexpr double kLeastSeen = 2;  // widths
  const auto radius = static_cast<double>(fit.radius);
  const auto width = static_cast<double>(width_along);
  const double seen = std::max(radius - kDark * width, kLeastSeen * width);
  return radius * radius * radius / (6 * seen) + 0.5 * width * width;
}

// Whether the bends at the ends of lines agree with the surface through the bends between them. The
// ends use directions of edges, which are wrong where a motion blur oblique to the edges turns
// them.
bool ends_agree(const Lattice& lattice, const Line& line, const Surface<5>& between) {
  constexpr double kMost = 3;  // ratio of the mean square difference to its variance
  double sum = 0;
  int ends = 0;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (line.has_both(c) || !line.has_any(c)) return;
    const double off = line.bend(c) - between.at(line.place(c));
    sum += off * off / line.variance(c);
    ++ends;
  });
  return sum <= kMost * between.variance() * ends;
}

// Sets the bends of all rows, or of all columns, to the values of the surface, and moves each fit
// to where a fit with that bend will find its corner.
template <int kDegree>
void take_bends(const Lattice& lattice, Cell step, const Line& line,
                const Surface<kDegree>& surface, FitGrid& fits) {
  // Three nodes give the mean of the bend over two squares, weighted by a triangle: off by 1/12 of
  // the second difference of the bends. A window reaches half as far and is off by a part of that.
  constexpr double kOfChange = 1.0 / 15;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const LatticePlace within = lattice.place(line.within(c));
    const double change = surface.at(moved(within, step, -1)) - 2 * surface.at(within) +
                          surface.at(moved(within, step, 1));
    const double bend = surface.at(lattice.place(c)) - kOfChange * change;
    SaddleFit& f = fits.at(c);
    float& own = line.is_row() ? f.along_bend : f.down_bend;
    const double move = error_per_bend(f, line.is_row() ? f.down_width : f.along_width) *
                        (static_cast<double>(own) - bend);
    const Direction side = line.normal(c);
    f.x += move * static_cast<double>(side.x);
    f.y += move * static_cast<double>(side.y);
    own = static_cast<float>(bend);
  });
}

void set_bends_of(const Lattice& lattice, Cell step, FitGrid& fits) {
  // The fewest nodes of a line for a surface of the fifth degree: from fewer, its error grows
  // without bound towards the ends of the line.
  constexpr int kLong = 6;
  const Line line(lattice, fits, step);
  const auto has = [&](Cell c) { return line.has_any(c); };
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (has(c)) fits.number(c) = static_cast<float>(line.bend(c));
  });
  const auto place = [&](Cell c) { return line.place(c); };
  const auto weight = [&](Cell c) { return 1 / line.variance(c); };
  const auto has_both = [&](Cell c) { return line.has_both(c); };
  const int length = line.is_row() ? lattice.extent().cols() : lattice.extent().rows();
  if (length < kLong) {
    const auto plain = surface_of<2>(lattice, fits, has_both, place, weight, 1);
    return take_bends(lattice, step, line, plain, fits);
  }
  auto surface = surface_of<5>(lattice, fits, has_both, place, weight, 1);
  if (ends_agree(lattice, line, surface)) {
    surface = surface_of<5>(lattice, fits, has, place, weight, 1);
  }
  take_bends(lattice, step, line, surface, fits);
}

}  // namespace

void set_bends(const Lattice& lattice, FitGrid& fits) {
  // The first fits took edges for straight and are off, and so are the bends computed from them:
  // the second round starts from places that the first has corrected.
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    set_bends_of(lattice, {1, 0}, fits);
    set_bends_of(lattice, {0, 1}, fits);
  }
}

void set_slopes(const Lattice& lattice, FitGrid& fits) {
  // Where more pixels than this are cut off at white or black, level and contrast are too
  // uncertain.
  constexpr float kMostCut = 0.05F;  // share of the window's pixels
  if (fits.median(lattice, [](const SaddleFit& f) { return f.cut; }) > kMostCut) return;
  const auto surface_through = [&](auto number) {
    lattice.for_each([&](Cell c, const Node& /*node*/) { fits.number(c) = number(fits.at(c)); });
    const auto all = [&](Cell c) { return lattice.has(c); };
    const auto there = [&](Cell c) { return lattice.place(c); };
    const auto alike = [](Cell /*c*/) { return 1.0; };
    return surface_of<2>(lattice, fits, all, there, alike, 0);
  };
  const auto level = surface_through([](const SaddleFit& f) { return f.level; });
  const auto contrast = surface_through([](const SaddleFit& f) { return std::abs(f.contrast); });
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    SaddleFit& f = fits.at(c);
    // The mean steps of a column and of a row, px, turn changes per step into a gradient per px.
    Direction step[2];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Cell ahead = lattice.has(c + kAround[axis]) ? c + kAround[axis] : c;
      const Cell behind = lattice.has(c - kAround[axis]) ? c - kAround[axis] : c;
      const LatticePlace from = lattice.place(behind);
      const LatticePlace to = lattice.place(ahead);
      const double steps = to.col - from.col + to.row - from.row;
      if (steps == 0) return;
      step[axis] = {static_cast<float>((fits.at(ahead).x - fits.at(behind).x) / steps),
                    static_cast<float>((fits.at(ahead).y - fits.at(behind).y) / steps)};
    }
    const float area = cross(step[0], step[1]);
    if (!(std::abs(area) > 1)) return;
    const auto gradient = [&](const Surface<2>& surface) {
      const LatticePlace at = lattice.place(c);
      const auto change = [&](Cell way) {
        return static_cast<float>(0.5 *
                                  (surface.at(moved(at, way, 1)) - surface.at(moved(at, way, -1))));
      };
      const float along = change({1, 0});
      const float down = change({0, 1});
      return Direction{(along * step[1].y - down * step[0].y) / area,
                       (down * step[0].x - along * step[1].x) / area};
    };
    f.slope = gradient(level);
    f.contrast_slope = gradient(contrast);
    if (f.contrast < 0) f.contrast_slope = -f.contrast_slope;
  });
}

ExpectedPlaces expect_places(const Lattice& lattice, FitGrid& fits, std::span<const Cell> cells) {
  const auto usual =
      static_cast<double>(fits.median(lattice, [](const SaddleFit& f) { return f.sigma; }));
  const auto surface_through = [&](auto number) {
    lattice.for_each([&](Cell c, const Node&) { fits.number(c) = number(fits.at(c)); });
    const auto all = [&](Cell c) { return lattice.has(c); };
    const auto there = [&](Cell c) { return lattice.place(c); };
    const auto weight = [&](Cell c) {
      const auto sigma = static_cast<double>(fits.at(c).sigma);
      return usual * usual / (sigma * sigma);
    };
    return surface_of<3>(lattice, fits, all, there, weight, usual * usual);
  };
  const auto x = surface_through([](const SaddleFit& f) { return static_cast<float>(f.x); });
  const auto y = surface_through([](const SaddleFit& f) { return static_cast<float>(f.y); });
  ExpectedPlaces expected;
  for (const Cell c : cells) {
    const LatticePlace at = lattice.place(c);
    expected.places.push_back({x.at(at), y.at(at)});
  }
  expected.sigma = static_cast<float>(std::sqrt(0.5 * (x.variance() + y.variance())));
  return expected;
}

}  // namespace calvin::detect
