// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/fit_grid.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace calvin::detect {

namespace {

// A polynomial over columns and rows, by least squares.
template <int kDegree>
class Surface {
 public:
  void add(Cell c, double value) {
    const Terms t = terms(c);
    normal_ += t * t.transpose();
    right_ += value * t;
    ++count_;
  }
  // Of as high a degree as the data tell; without any it is 0.
  void solve() {
    int degree = kDegree;
    while (degree > 0 && count_ < 2 * terms_of(degree) - 1) --degree;
    const int terms = terms_of(degree);
    coefficients_.setZero();
    if (count_ == 0) return;
    // A little of a prior: there may be but two columns.
    Eigen::Matrix<double, kTerms, kTerms> n = Eigen::Matrix<double, kTerms, kTerms>::Identity();
    n.topLeftCorner(terms, terms) = normal_.topLeftCorner(terms, terms);
    n.diagonal().array() += 1e-6 * count_;
    Terms right = Terms::Zero();
    right.head(terms) = right_.head(terms);
    coefficients_ = n.ldlt().solve(right);
  }
  [[nodiscard]] double at(Cell c) const { return terms(c).dot(coefficients_); }

 private:
  static constexpr int terms_of(int degree) { return (degree + 1) * (degree + 2) / 2; }
  static constexpr int kTerms = terms_of(kDegree);
  using Terms = Eigen::Matrix<double, kTerms, 1>;
  // Those of a lower degree first.
  static Terms terms(Cell c) {
    const double x = 0.1 * c.col;
    const double y = 0.1 * c.row;
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

  int count_ = 0;
  Eigen::Matrix<double, kTerms, kTerms> normal_ = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Terms right_ = Terms::Zero();
  Terms coefficients_ = Terms::Zero();
};

// Through the numbers of the nodes that have one, but for those that stand out: something lies over
// a part of the board.
template <int kDegree, typename H>
Surface<kDegree> surface_of(const Lattice& lattice, FitGrid& fits, H has) {
  constexpr float kOut = 5;  // times the median
  Surface<kDegree> all;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (has(c)) all.add(c, static_cast<double>(fits.number(c)));
  });
  all.solve();
  const auto off = [&](Cell c) { return std::abs(fits.number(c) - static_cast<float>(all.at(c))); };
  const float most = kOut * fits.median_where(lattice, has, off);
  bool none = true;
  lattice.for_each(
      [&](Cell c, const Node& /*node*/) { none = none && !(has(c) && off(c) > most); });
  if (none) return all;
  Surface<kDegree> kept;
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (has(c) && off(c) <= most) kept.add(c, static_cast<double>(fits.number(c)));
  });
  kept.solve();
  return kept;
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
float bend_variance(const SaddleFit& at, const SaddleFit& after) {
  const auto u = static_cast<float>(after.x - at.x);
  const auto v = static_cast<float>(after.y - at.y);
  const float square = u * u + v * v;
  return 6 * at.sigma * at.sigma / (square * square);
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
  const auto surface = surface_of<3>(lattice, fits, has_own);
  // What is left of them beside the surface.
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    if (has_own(c)) fits.number(c) -= static_cast<float>(surface.at(c));
  });
  // What the nodes around one say of its bend counts as much as the surface is off by more than
  // their noise explains: next to nothing but for a fisheye.
  const auto around = [&](Cell c) {
    float sum = 0;
    float count = 0;
    for (int row = -1; row <= 1; ++row) {
      for (int col = -1; col <= 1; ++col) {
        const Cell other = c + Cell{col, row};
        if (!has_own(other)) continue;
        sum += fits.number(other);
        count += 1;
      }
    }
    return count > 0 ? sum / count : 0;
  };
  constexpr float kNodes = 9;
  const auto variance = [&](Cell c) {
    return bend_variance(fits.at(c), fits.at(c + step)) / kNodes;
  };
  const float excess =
      std::max(fits.median_where(lattice, has_own,
                                 [&](Cell c) { return around(c) * around(c) - variance(c); }),
               0.0F);
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    // The last one of a row has none of its own, but the one before it.
    const Cell known = has_own(c) ? c : has_own(c + step) ? c + step : c - step;
    const float local =
        has_own(known) && excess > 0 ? around(c) * excess / (excess + variance(known)) : 0;
    SaddleFit& f = fits.at(c);
    (is_row ? f.along_bend : f.down_bend) = static_cast<float>(surface.at(c)) + local;
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
    return surface_of<2>(lattice, fits, [](Cell /*c*/) { return true; });
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
