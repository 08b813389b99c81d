// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// LensMap: from a plane to a picture, by the points of one view alone. It is the lens that makes
// the picture of a board when nobody knows the camera yet.
//
//   v = H (x, y, 1),  q = v_xy / v_z  or  q = angle(v) v_xy / |v_xy|,
//   p0 = middle + scale q (1 + k1 |q|^2 + k2 |q|^4),  p = p0 + e(p0)
//
// with a polynomial e for what is left. The second form, that of an equidistant fisheye lens, takes
// over where the first one does not fit.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "calvin/core/image.hpp"

namespace calvin::detect {

enum class Projection { kPerspective, kEquidistant };

// A polynomial over an image.
class Polynomial {
 public:
  Polynomial() = default;
  // Through values at points, a row of two to kMostValues for each, of the highest degree of which
  // there are half as many points again as numbers, `highest` and 5 at most.
  Polynomial(std::span<const Pixel> at, const Eigen::MatrixXd& values, int highest = 3);

  // Of each of the values.
  [[nodiscard]] int numbers() const { return static_cast<int>(numbers_.rows()); }

  // The first two of the values.
  [[nodiscard]] Eigen::Vector2d at(const Pixel& p) const;
  static constexpr int kMostValues = 6;
  using Values = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMostValues>;
  [[nodiscard]] Values all_at(const Pixel& p) const;

 private:
  static constexpr int kHighest = 5;
  static constexpr int kMostTerms = (kHighest + 1) * (kHighest + 2) / 2;
  using Terms = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostTerms, 1>;

  [[nodiscard]] Terms terms(const Pixel& p) const;

  Pixel middle_;
  double half_ = 1;  // px
  int degree_ = -1;
  Eigen::MatrixXd numbers_;  // a column for each of the values
};

class LensMap {
 public:
  // Points of a plane, whose images are known to a small part of their distances, in a picture with
  // that middle, px; `sigma`: px, how well they are known; `degree`: the highest of the polynomial.
  // Absent where they have no map.
  [[nodiscard]] static std::optional<LensMap> fit(std::span<const Pixel> plane,
                                                  std::span<const Pixel> image, const Pixel& middle,
                                                  double sigma = 0, int degree = 3);

  [[nodiscard]] Pixel image_of(const Pixel& p) const;
  // Of the points that it was made of, RMS, px.
  [[nodiscard]] double misfit() const { return misfit_; }

 private:
  // h by rows but for its last element, k1, k2, the logarithm of the scale.
  static constexpr int kNumbers = 11;
  using Numbers = Eigen::Matrix<double, kNumbers, 1>;
  using Jacobian = Eigen::Matrix<double, 2, kNumbers>;

  LensMap(Projection projection, const Eigen::Matrix3d& h, const Pixel& middle, double scale);

  static std::optional<LensMap> start(Projection projection, std::span<const Pixel> plane,
                                      std::span<const Pixel> image, const Pixel& middle,
                                      double scale, int degree);
  // Without the polynomial.
  [[nodiscard]] Pixel project(const Pixel& p, Jacobian* jacobian = nullptr) const;
  [[nodiscard]] double square_error(std::span<const Pixel> plane,
                                    std::span<const Pixel> image) const;
  void improve(std::span<const Pixel> plane, std::span<const Pixel> image);
  void add_rest(std::span<const Pixel> plane, std::span<const Pixel> image, int degree);

  Projection projection_;
  Numbers numbers_;
  Eigen::Vector2d middle_;
  Polynomial rest_;
  double misfit_ = 0;
};

}  // namespace calvin::detect
