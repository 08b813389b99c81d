// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/fit_grid.hpp"

#include <cmath>

#include <Eigen/Core>

namespace calvin::detect {

namespace {

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
  [[nodiscard]] Terms terms(Cell c) const {
    const double x = (c.col - middle_col_) / half_cols_;
    const double y = (c.row - middle_row_) / half_rows_;
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
  void add(Cell c, double value, double weight) {
    const Terms t = terms(c);
    normal_.template selfadjointView<Eigen::Lower>().rankUpdate(t, weight);
    right_ += weight * value * t;
  }
  // Of as high a degree as the data tell; without any it is 0. `variance`: of a value of weight 1.
  // Terms of a degree that are not clearly more than it makes them are left out, for noise in them
  // is largest at the border of the lattice; others are made smaller by its share (James and Stein,
  // Estimation with Quadratic Loss, 1961). The higher ones, which only a wide lens has, must be
  // much more: the noise of compressed pictures is not independent, and larger than it seems.
  void solve(double variance) {
    constexpr int kFirst = 3;  // degree in doubt
    constexpr int kUsual = 3;  // the highest degree without a wide lens
    constexpr double kClearly = 3;
    constexpr double kMuchMore = 20;
    orthogonalise();
    for (int degree = kFirst; degree <= kDegree; ++degree) {
      const int first = terms_of(degree - 1);
      auto block = right_.segment(first, terms_of(degree) - first);
      const double square = block.squaredNorm();
      const double noise = variance * static_cast<double>((block.array() != 0).count());
      const double least = (degree > kUsual ? kMuchMore : kClearly) * noise;
      block *= square > least ? 1 - noise / square : 0;
    }
    for (int k = kTerms - 1; k >= 0; --k) {
      const int rest = kTerms - 1 - k;
      const double others = normal_.col(k).tail(rest).dot(coefficients_.tail(rest));
      coefficients_[k] = normal_(k, k) > 0 ? (right_[k] - others) / normal_(k, k) : 0;
    }
  }
  [[nodiscard]] double at(Cell c) const { return terms(c).dot(coefficients_); }

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

  double middle_col_;
  double middle_row_;
  double half_cols_;
  double half_rows_;
  Eigen::Matrix<double, kTerms, kTerms> normal_ = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Terms right_ = Terms::Zero();
  Terms coefficients_ = Terms::Zero();
};

// Through the numbers of the nodes that have one, but for those that stand out: something lies over
// a part of the board. `weight(cell)`, `variance`: as in Surface.
template <int kDegree, typename H, typename W>
Surface<kDegree> surface_of(const Lattice& lattice, FitGrid& fits, H has, W weight,
                            double variance) {
  constexpr float kOut = 5;  // times the median
  const auto through = [&](auto is_in) {
    Surface<kDegree> surface(lattice.extent());
    lattice.for_each([&](Cell c, const Node& /*node*/) {
      if (is_in(c)) surface.add(c, static_cast<double>(fits.number(c)), weight(c));
    });
    surface.solve(variance);
    return surface;
  };
  const Surface<kDegree> all = through(has);
  const auto off = [&](Cell c) { return std::abs(fits.number(c) - static_cast<float>(all.at(c))); };
  const float most = kOut * fits.median_where(lattice, has, off);
  const auto is_in = [&](Cell c) { return has(c) && off(c) <= most; };
  bool none = true;
  lattice.for_each([&](Cell c, const Node& /*node*/) { none = none && has(c) == is_in(c); });
  return none ? all : through(is_in);
}

// How much a line bends at its middle one of three nodes, 1/px, towards `normal`.
double bend(const SaddleFit& before, const SaddleFit& at, const SaddleFit& after,
            Direction normal) {
  const double half = std::hypot(after.x - before.x, after.y - before.y) / 2;
  const double u = before.x - 2 * at.x + after.x;
  const double v = before.y - 2 * at.y + after.y;
  return (static_cast<double>(normal.x) * u + static_cast<double>(normal.y) * v) / (half * half);
}

// Of a bend, 1/px^2, from the places of three nodes.
double bend_variance(const SaddleFit& at, const SaddleFit& after) {
  const double u = after.x - at.x;
  const double v = after.y - at.y;
  const double square = u * u + v * v;
  return 6 * static_cast<double>(at.sigma) * static_cast<double>(at.sigma) / (square * square);
}

}  // namespace

namespace {

// The bends of all rows, or of all columns.
void set_bends_of(const Lattice& lattice, Cell step, FitGrid& fits) {
  const bool is_row = step.row == 0;
  const auto has_own = [&](Cell c) {
    return lattice.has(c) && lattice.has(c + step) && lattice.has(c - step);
  };
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (!has_own(c)) return;
    const SaddleFit& f = fits.at(c);
    const Direction normal =
        is_row ? Direction{-f.along.y, f.along.x} : Direction{f.down.y, -f.down.x};
    fits.number(c) = static_cast<float>(bend(fits.at(c - step), f, fits.at(c + step), normal));
  });
  const auto weight = [&](Cell c) { return 1 / bend_variance(fits.at(c), fits.at(c + step)); };
  const auto surface = surface_of<5>(lattice, fits, has_own, weight, 1);
  // Three nodes tell the mean of the bend over two squares, which is off by 1/12 of how the bends
  // of neighbours differ from it; a window reaches half as far and is off by less.
  constexpr double kOfChange = 1.0 / 15;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const double mean = surface.at(c);
    const double change = surface.at(c - step) - 2 * mean + surface.at(c + step);
    SaddleFit& f = fits.at(c);
    (is_row ? f.along_bend : f.down_bend) = static_cast<float>(mean - kOfChange * change);
  });
}

}  // namespace

void set_bends(const Lattice& lattice, FitGrid& fits) {
  set_bends_of(lattice, {1, 0}, fits);
  set_bends_of(lattice, {0, 1}, fits);
}

void set_slopes(const Lattice& lattice, FitGrid& fits) {
  // Where the squares are cut off at white, level and contrast are not known well enough.
  constexpr float kMostCut = 0.05F;
  if (fits.median(lattice, [](const SaddleFit& f) { return f.cut; }) > kMostCut) return;
  const auto surface_through = [&](auto number) {
    lattice.for_each([&](Cell c, const Node& /*node*/) { fits.number(c) = number(fits.at(c)); });
    const auto all = [&](Cell c) { return lattice.has(c); };
    const auto alike = [](Cell /*c*/) { return 1.0; };
    return surface_of<2>(lattice, fits, all, alike, 0);
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
