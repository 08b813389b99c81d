// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Polynomial surfaces through the fits of a board: the bends of its edges, the fall of light.

#include "calvin/detect/fit_grid.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Core>

namespace calvin::detect {

namespace {

// A place in a lattice, between its nodes too.
struct Spot {
  double col;
  double row;

  Spot(double at_col, double at_row) : col(at_col), row(at_row) {}
  // Every cell is one.
  Spot(Cell c) : col(c.col), row(c.row) {}  // NOLINT(google-explicit-constructor)
};

// A polynomial over columns and rows, by least squares.
template <int kDegree>
class Surface {
 public:
  static constexpr int terms_of(int degree) { return (degree + 1) * (degree + 2) / 2; }
  static constexpr int kTerms = terms_of(kDegree);
  using Terms = Eigen::Matrix<double, kTerms, 1>;

  explicit Surface(const Extent& extent)
      : middle_col_(0.5 * (extent.first.col + extent.last.col)),
        middle_row_(0.5 * (extent.first.row + extent.last.row)),
        half_cols_(std::max(0.5 * (extent.cols() - 1), 1.0)),
        half_rows_(std::max(0.5 * (extent.rows() - 1), 1.0)) {}

  // Those of a lower degree first. From -1 to 1 over the lattice.
  [[nodiscard]] Terms terms(Spot s) const {
    const double x = (s.col - middle_col_) / half_cols_;
    const double y = (s.row - middle_row_) / half_rows_;
    Terms t;
    t[0] = 1;
    int before = 0;  // the first of a degree less
    int k = 1;
    for (int degree = 1; degree <= kDegree; before += degree++) {
      for (int i = 0; i < degree; ++i) t[k++] = x * t[before + i];
      t[k++] = y * t[before + degree - 1];
    }
    return t;
  }
  // `weight`: 1 / the variance of the value, where it is known.
  void add(Spot s, double value, double weight) {
    const Terms t = terms(s);
    normal_.template selfadjointView<Eigen::Lower>().rankUpdate(t, weight);
    right_ += weight * value * t;
    square_ += weight * value * value;
    ++count_;
  }
  // Of as high a degree as the data tell; without any it is 0. `variance`: of a value of weight 1,
  // at the least. Terms of a degree that are not clearly more than it makes them are left out, for
  // noise in them is largest at the border of the lattice; others are made smaller by its share
  // (James and Stein, Estimation with Quadratic Loss, 1961).
  void solve(double variance) {
    constexpr int kFirst = 3;  // degree in doubt
    constexpr double kClearly = 3;
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
  [[nodiscard]] double at(Spot s) const { return terms(s).dot(coefficients_); }
  // Of a value of weight 1, as the values tell.
  [[nodiscard]] double variance() const { return variance_; }

 private:
  // Takes the normal matrix to its factor of Cholesky, and the right side to the coefficients of
  // terms that are orthonormal over the data: each has the variance of a value. Terms that cannot
  // be told from those before are left out, 0.
  void orthogonalise() {
    constexpr double kNew = 1e-3;  // of a term's square
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

  // The variance by what all terms together leave, as if some values more had the one presumed:
  // the noise of compressed pictures is larger than it seems.
  [[nodiscard]] double measured(double presumed) const {
    constexpr double kPresumed = 4;
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

// Through the numbers of the nodes that have one, but for those that stand out: something lies over
// a part of the board. `spot(cell)`: where it is of; `weight(cell)`, `variance`: as in Surface.
template <int kDegree, typename H, typename S, typename W>
Surface<kDegree> surface_of(const Lattice& lattice, FitGrid& fits, H has, S spot, W weight,
                            double variance) {
  constexpr float kOut = 5;  // times the median
  const auto through = [&](auto is_in) {
    Surface<kDegree> surface(lattice.extent());
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      if (is_in(c)) surface.add(spot(c), static_cast<double>(fits.number(c)), weight(c));
    });
    surface.solve(variance);
    return surface;
  };
  const Surface<kDegree> all = through(has);
  const auto off = [&](Cell c) {
    return std::abs(fits.number(c) - static_cast<float>(all.at(spot(c))));
  };
  const float most = kOut * fits.median_where(lattice, has, off);
  const auto is_in = [&](Cell c) { return has(c) && off(c) <= most; };
  bool none = true;
  lattice.for_each([&](Cell c, const Node& /*node*/) { none = none && has(c) == is_in(c); });
  return none ? all : through(is_in);
}

// How a line bends, as the nodes next to each other on it tell.
class Line {
 public:
  Line(const Lattice& lattice, const FitGrid& fits, Cell step)
      : lattice_(lattice), fits_(fits), step_(step) {}

  [[nodiscard]] bool is_row() const { return step_.row == 0; }
  // The side to which it bends.
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
  // The same node, or the next one to an end: beyond it nothing tells how bends change.
  [[nodiscard]] Cell within(Cell c) const {
    if (has_both(c)) return c;
    if (has_both(c + step_)) return c + step_;
    return has_both(c - step_) ? c - step_ : c;
  }
  // 1/px: by the nodes before and after it, or at an end by the next one and its own direction.
  [[nodiscard]] double bend(Cell c) const {
    double square = 0;
    double off = 0;
    const Direction side = normal(c);
    for (const Cell next : {c + step_, c - step_}) {
      if (!lattice_.has(next)) continue;
      const auto [u, v] = way(c, next);
      off += static_cast<double>(side.x) * u + static_cast<double>(side.y) * v;
      square += u * u + v * v;
    }
    return 2 * off / square;
  }
  [[nodiscard]] double variance(Cell c) const {
    const SaddleFit& f = fits_.at(c);
    const auto sigma = static_cast<double>(f.sigma);
    const double square = square_to_next(c);
    if (has_both(c)) return 6 * sigma * sigma / (square * square);
    // A direction is told to 3 sigma^2 / radius^2.
    const auto radius = static_cast<double>(f.radius);
    return sigma * sigma * (8 / square + 12 / (radius * radius)) / square;
  }
  // Where it bends as much: an end sees to the next node, less what its own window takes of it.
  [[nodiscard]] Spot spot(Cell c) const {
    if (has_both(c)) return c;
    const auto radius = static_cast<double>(fits_.at(c).radius);
    double inwards = 1.0 / 3 - radius * radius / (5 * square_to_next(c));
    if (!lattice_.has(c + step_)) inwards = -inwards;
    return {c.col + inwards * step_.col, c.row + inwards * step_.row};
  }

 private:
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

// How far a fit that does not know of a bend is off, px^2 times the bend: by the mean over its
// window of half the square of the way along the edge, which says little next to the corner, and by
// what blur adds to it.
double reach(const SaddleFit& fit, float width_along) {
  constexpr double kDark = 1.13;    // widths of the edge that crosses, next to which none is seen
  constexpr double kLeastSeen = 2;  // widths
  const auto radius = static_cast<double>(fit.radius);
  const auto width = static_cast<double>(width_along);
  const double seen = std::max(radius - kDark * width, kLeastSeen * width);
  return radius * radius * radius / (6 * seen) + 0.5 * width * width;
}

// Whether the ends of lines say of the bends what the nodes between them do. They do not where the
// directions of edges are off: motion that is oblique to them turns how all of them look.
bool ends_agree(const Lattice& lattice, const Line& line, const Surface<5>& between) {
  constexpr double kMost = 3;  // times what they differ by their variance alone
  double sum = 0;
  int ends = 0;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (line.has_both(c) || !line.has_any(c)) return;
    const double off = line.bend(c) - between.at(line.spot(c));
    sum += off * off / line.variance(c);
    ++ends;
  });
  return sum <= kMost * between.variance() * ends;
}

// The bends of all rows, or of all columns, as the surface has them; the fits are moved to where
// they will be with them.
template <int kDegree>
void take_bends(const Lattice& lattice, Cell step, const Line& line,
                const Surface<kDegree>& surface, FitGrid& fits) {
  // Three nodes tell the mean of the bend over two squares, which is off by 1/12 of how the bends
  // of neighbours differ from it; a window reaches half as far and is off by less.
  constexpr double kOfChange = 1.0 / 15;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const Cell within = line.within(c);
    const double change =
        surface.at(within - step) - 2 * surface.at(within) + surface.at(within + step);
    const double bend = surface.at(c) - kOfChange * change;
    SaddleFit& f = fits.at(c);
    float& own = line.is_row() ? f.along_bend : f.down_bend;
    const double move =
        reach(f, line.is_row() ? f.down_width : f.along_width) * (static_cast<double>(own) - bend);
    const Direction side = line.normal(c);
    f.x += move * static_cast<double>(side.x);
    f.y += move * static_cast<double>(side.y);
    own = static_cast<float>(bend);
  });
}

void set_bends_of(const Lattice& lattice, Cell step, FitGrid& fits) {
  // Nodes of a line that tell how its bend changes: what fewer seem to say grows towards its ends.
  constexpr int kLong = 6;
  const Line line(lattice, fits, step);
  const auto has = [&](Cell c) { return line.has_any(c); };
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (has(c)) fits.number(c) = static_cast<float>(line.bend(c));
  });
  const auto spot = [&](Cell c) { return line.spot(c); };
  const auto weight = [&](Cell c) { return 1 / line.variance(c); };
  const auto has_both = [&](Cell c) { return line.has_both(c); };
  const int length = line.is_row() ? lattice.extent().cols() : lattice.extent().rows();
  if (length < kLong) {
    const auto plain = surface_of<2>(lattice, fits, has_both, spot, weight, 1);
    return take_bends(lattice, step, line, plain, fits);
  }
  auto surface = surface_of<5>(lattice, fits, has_both, spot, weight, 1);
  if (ends_agree(lattice, line, surface)) {
    surface = surface_of<5>(lattice, fits, has, spot, weight, 1);
  }
  take_bends(lattice, step, line, surface, fits);
}

}  // namespace

void set_bends(const Lattice& lattice, FitGrid& fits) {
  // The first fits are off by what they do not know of the bends, and so are the bends by them.
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    set_bends_of(lattice, {1, 0}, fits);
    set_bends_of(lattice, {0, 1}, fits);
  }
}

void set_slopes(const Lattice& lattice, FitGrid& fits) {
  // Where the squares are cut off at white, level and contrast are not known well enough.
  constexpr float kMostCut = 0.05F;
  if (fits.median(lattice, [](const SaddleFit& f) { return f.cut; }) > kMostCut) return;
  const auto surface_through = [&](auto number) {
    lattice.for_each([&](Cell c, const Node& /*node*/) { fits.number(c) = number(fits.at(c)); });
    const auto all = [&](Cell c) { return lattice.has(c); };
    const auto there = [](Cell c) { return Spot(c); };
    const auto alike = [](Cell /*c*/) { return 1.0; };
    return surface_of<2>(lattice, fits, all, there, alike, 0);
  };
  const auto level = surface_through([](const SaddleFit& f) { return f.level; });
  const auto contrast = surface_through([](const SaddleFit& f) { return std::abs(f.contrast); });
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    SaddleFit& f = fits.at(c);
    // The steps of a column and of a row, px, take the changes per cell to a gradient.
    Direction step[2];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Cell ahead = lattice.has(c + kAround[axis]) ? c + kAround[axis] : c;
      const Cell behind = lattice.has(c - kAround[axis]) ? c - kAround[axis] : c;
      const int cells = (ahead - behind).col + (ahead - behind).row;
      if (cells == 0) return;
      step[axis] = {static_cast<float>((fits.at(ahead).x - fits.at(behind).x) / cells),
                    static_cast<float>((fits.at(ahead).y - fits.at(behind).y) / cells)};
    }
    const float area = cross(step[0], step[1]);
    if (!(std::abs(area) > 1)) return;
    const auto gradient = [&](const Surface<2>& surface) {
      const auto change = [&](Cell way) {
        return static_cast<float>(0.5 * (surface.at(c + way) - surface.at(c - way)));
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

}  // namespace calvin::detect
