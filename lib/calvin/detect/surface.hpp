// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A polynomial surface through values at the places of a lattice.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace calvin::detect {

// A place on the board of a lattice, in mean steps from a line to the next; may lie between nodes.
struct LatticePlace {
  double col = 0;
  double row = 0;
};

// A value at a place of a lattice. `weight` is 1 / variance of the value, up to a factor that all
// values share.
struct PlacedValue {
  LatticePlace at;
  double value = 0;
  double weight = 1;
};

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

  void add(const PlacedValue& v) {
    const auto t = monomials<2 * kDegree>(v.at);
    moments_ += v.weight * t;
    right_ += v.weight * v.value * t.template head<kTerms>();
    square_ += v.weight * v.value * v.value;
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
    set_normal();
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
  [[nodiscard]] double at(const LatticePlace& s) const {
    return monomials<kDegree>(s).dot(coefficients_);
  }
  // The variance of a value of weight 1, measured by the residuals.
  [[nodiscard]] double variance() const { return variance_; }
  // The variance of at(s), of the terms that were not left out.
  [[nodiscard]] double variance_at(const LatticePlace& s) const {
    Terms t = monomials<kDegree>(s);
    double sum = 0;
    for (int k = 0; k < kTerms; ++k) {
      if (!(normal_(k, k) > 0)) continue;
      t[k] /= normal_(k, k);
      t.tail(kTerms - k - 1) -= t[k] * normal_.col(k).tail(kTerms - k - 1);
      if (right_[k] != 0) sum += t[k] * t[k];
    }
    return variance_ * sum;
  }

 private:
  // Powers of x times powers of y at a place, those of a lower degree first and in each degree
  // those with more of x, in coordinates that run from -1 to 1 over the lattice.
  template <int kHighest>
  [[nodiscard]] Eigen::Matrix<double, terms_of(kHighest), 1> monomials(
      const LatticePlace& s) const {
    const double x = (s.col - middle_col_) / half_cols_;
    const double y = (s.row - middle_row_) / half_rows_;
    Eigen::Matrix<double, terms_of(kHighest), 1> t;
    t[0] = 1;
    int before = 0;  // index of the first term of the degree below
    int k = 1;
    for (int degree = 1; degree <= kHighest; before += degree++) {
      for (int i = 0; i < degree; ++i) t[k++] = x * t[before + i];
      t[k++] = y * t[before + degree - 1];
    }
    return t;
  }

  // Sets the lower half of the normal matrix: the product of two terms is a term of a higher
  // degree, so that there are far fewer different sums than pairs of terms.
  void set_normal() {
    int row = 0;
    for (int degree = 0; degree <= kDegree; ++degree) {
      for (int i = 0; i <= degree; ++i, ++row) {
        int col = 0;
        for (int lower = 0; lower <= degree; ++lower) {
          const int first = terms_of(degree + lower - 1);
          for (int j = 0; j <= lower && col <= row; ++j, ++col) {
            normal_(row, col) = moments_[first + i + j];
          }
        }
      }
    }
  }

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
  using Moments = Eigen::Matrix<double, terms_of(2 * kDegree), 1>;
  Moments moments_ = Moments::Zero();  // weighted sums of products of two terms
  Eigen::Matrix<double, kTerms, kTerms> normal_ = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Terms right_ = Terms::Zero();
  Terms coefficients_ = Terms::Zero();
  double square_ = 0;  // of the values, weighted
  double count_ = 0;
  double variance_ = 0;
};

// The surface through the values that do not stand out from a first surface, because something may
// lie over a part of the board. `none` has no values, `all` has all of them, and neither is solved;
// `variance` is that of Surface::solve().
template <int kDegree>
[[nodiscard]] Surface<kDegree> surface_through(const Surface<kDegree>& none, Surface<kDegree> all,
                                               std::span<const PlacedValue> values,
                                               double variance) {
  constexpr double kOut = 5;  // times the median distance from the first surface
  all.solve(variance);
  if (values.empty()) return all;
  std::vector<double> off(values.size());
  std::ranges::transform(values, off.begin(),
                         [&](const PlacedValue& v) { return std::abs(v.value - all.at(v.at)); });
  std::vector<double> sorted = off;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double most = kOut * *middle;
  if (*std::ranges::max_element(off) <= most) return all;
  Surface<kDegree> surface = none;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (off[i] <= most) surface.add(values[i]);
  }
  surface.solve(variance);
  return surface;
}

}  // namespace calvin::detect
