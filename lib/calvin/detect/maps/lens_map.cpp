// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Damped Gauss-Newton steps from a homography, and a polynomial for the rest.

#include "calvin/detect/maps/lens_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/homography.hpp"

namespace calvin::detect {

namespace {

enum Number { kOfK1 = 8, kOfK2 = 9, kOfScale = 10 };

int numbers_of(int degree) { return (degree + 1) * (degree + 2) / 2; }

Eigen::Vector2d vector_of(const Pixel& p) { return {p.u, p.v}; }

// q of a direction v, and its derivatives by v.
Eigen::Vector2d projected(Projection projection, const Eigen::Vector3d& v,
                          Eigen::Matrix<double, 2, 3>& by_v) {
  const Eigen::Vector2d xy = v.head<2>();
  if (projection == Projection::kPerspective) {
    by_v << 1 / v.z(), 0, -v.x() / (v.z() * v.z()), 0, 1 / v.z(), -v.y() / (v.z() * v.z());
    return xy / v.z();
  }
  const double aside = std::max(xy.norm(), 1e-12);
  const double square = aside * aside + v.z() * v.z();
  const double angle = std::atan2(aside, v.z());
  const Eigen::Vector2d way = xy / aside;
  const Eigen::Matrix2d along = way * way.transpose();
  by_v.leftCols<2>() =
      v.z() / square * along + angle / aside * (Eigen::Matrix2d::Identity() - along);
  by_v.col(2) = -aside / square * way;
  return angle * way;
}

}  // namespace

// ---- Polynomial ---------------------------------------------------------------------------------

Polynomial::Polynomial(std::span<const Pixel> at, const Eigen::MatrixXd& values, int highest) {
  const auto [left, right] = std::ranges::minmax(at, {}, &Pixel::u);
  const auto [top, bottom] = std::ranges::minmax(at, {}, &Pixel::v);
  middle_ = {(left.u + right.u) / 2, (top.v + bottom.v) / 2};
  half_ = std::max({right.u - left.u, bottom.v - top.v, 1e-9}) / 2;
  while (degree_ < std::min(highest, kHighest) &&
         3 * numbers_of(degree_ + 1) <= 2 * static_cast<int>(at.size())) {
    ++degree_;
  }
  if (degree_ < 0) {
    numbers_.resize(0, values.cols());
    return;
  }
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(at.size()), numbers_of(degree_));
  for (std::size_t i = 0; i < at.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = terms(at[i]).transpose();
  }
  Eigen::MatrixXd m = rows.transpose() * rows;
  m.diagonal().array() += 1e-6;  // points in few rows do not tell all numbers
  numbers_ = solve_symmetric(m, rows.transpose() * values);
}

// Those of a degree are x times those of the degree below, and a last one.
Polynomial::Terms Polynomial::terms(const Pixel& p) const {
  const double x = (p.u - middle_.u) / half_;
  const double y = (p.v - middle_.v) / half_;
  Terms all(numbers_of(degree_));
  all[0] = 1;
  Eigen::Index before = 0;  // the first one of the degree below
  Eigen::Index k = 1;
  for (int degree = 1; degree <= degree_; before += degree++) {
    for (int i = 0; i < degree; ++i) all[k++] = x * all[before + i];
    all[k++] = y * all[before + degree - 1];
  }
  return all;
}

Eigen::Vector2d Polynomial::at(const Pixel& p) const {
  if (degree_ < 0) return Eigen::Vector2d::Zero();
  const Terms all = terms(p);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index k = 0; k < all.size(); ++k) {
    sum += all[k] * Eigen::Vector2d(numbers_(k, 0), numbers_(k, 1));
  }
  return sum;
}

Polynomial::Values Polynomial::all_at(const Pixel& p) const {
  if (degree_ < 0) return Values::Zero(numbers_.cols());
  const Terms all = terms(p);
  Values sum = Values::Zero(numbers_.cols());
  for (Eigen::Index k = 0; k < all.size(); ++k) sum += all[k] * numbers_.row(k);
  return sum;
}

// ---- LensMap ------------------------------------------------------------------------------------

LensMap::LensMap(Projection projection, const Eigen::Matrix3d& h, const Pixel& middle, double scale)
    : projection_(projection), middle_(middle.u, middle.v) {
  for (int i = 0; i < 8; ++i) numbers_[i] = h(i / 3, i % 3) / h(2, 2);
  numbers_[kOfK1] = 0;
  numbers_[kOfK2] = 0;
  numbers_[kOfScale] = std::log(scale);
}

Pixel LensMap::project(const Pixel& p, Jacobian* jacobian) const {
  const Eigen::Vector3d x(p.u, p.v, 1);
  const Eigen::Vector3d v(numbers_.segment<3>(0).dot(x), numbers_.segment<3>(3).dot(x),
                          numbers_.segment<2>(6).dot(x.head<2>()) + 1);
  Eigen::Matrix<double, 2, 3> by_v;
  const Eigen::Vector2d q = projected(projection_, v, by_v);
  const double square = q.squaredNorm();
  const double gain = 1 + square * (numbers_[kOfK1] + square * numbers_[kOfK2]);
  const double scale = std::exp(numbers_[kOfScale]);
  const Eigen::Vector2d image = middle_ + scale * gain * q;
  if (jacobian != nullptr) {
    const double slope = numbers_[kOfK1] + 2 * square * numbers_[kOfK2];
    const Eigen::Matrix2d by_q =
        scale * (gain * Eigen::Matrix2d::Identity() + 2 * slope * q * q.transpose());
    const Eigen::Matrix<double, 2, 3> by_direction = by_q * by_v;
    jacobian->block<2, 3>(0, 0) = by_direction.col(0) * x.transpose();
    jacobian->block<2, 3>(0, 3) = by_direction.col(1) * x.transpose();
    jacobian->block<2, 2>(0, 6) = by_direction.col(2) * x.head<2>().transpose();
    jacobian->col(kOfK1) = scale * square * q;
    jacobian->col(kOfK2) = scale * square * square * q;
    jacobian->col(kOfScale) = image - middle_;
  }
  return {image.x(), image.y()};
}

double LensMap::square_error(std::span<const Pixel> plane, std::span<const Pixel> image) const {
  double sum = 0;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    sum += (vector_of(image[i]) - vector_of(project(plane[i]))).squaredNorm();
  }
  return sum;
}

void LensMap::improve(std::span<const Pixel> plane, std::span<const Pixel> image) {
  constexpr int kSteps = 12;
  constexpr double kConverged = 1e-4;  // of the error
  // 1 sigma where points tell little: of k1 and k2, and of the scale, which a homography has
  // itself.
  const Numbers known = (Numbers() << 0, 0, 0, 0, 0, 0, 0, 0, 4, 4,
                         projection_ == Projection::kPerspective ? 1e12 : 1e-2)
                            .finished();
  double damping = 1e-4;
  double error = square_error(plane, image);
  const double scale_at_start = numbers_[kOfScale];
  for (int step = 0; step < kSteps; ++step) {
    // Two rows at a time by sums of vectors of a fixed size: far quicker than products of matrices.
    Eigen::Matrix<double, kNumbers, kNumbers> m = Eigen::Matrix<double, kNumbers, kNumbers>::Zero();
    Numbers right = Numbers::Zero();
    for (std::size_t i = 0; i < plane.size(); ++i) {
      Jacobian j;
      const Eigen::Vector2d lacks = vector_of(image[i]) - vector_of(project(plane[i], &j));
      const Eigen::Matrix<double, kNumbers, 2> rows = j.transpose();
      for (int k = 0; k < kNumbers; ++k) {
        m.col(k) += rows.col(0) * rows(k, 0) + rows.col(1) * rows(k, 1);
      }
      right += rows.col(0) * lacks.x() + rows.col(1) * lacks.y();
    }
    m.diagonal() += known;
    Numbers off = numbers_;
    off[kOfScale] -= scale_at_start;
    right -= known.asDiagonal() * off;
    const Numbers unit = m.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = unit.asDiagonal() * m * unit.asDiagonal();
    scaled.diagonal().array() += damping;
    const Numbers before = numbers_;
    numbers_ += unit.asDiagonal() * solve_symmetric(scaled, unit.asDiagonal() * right);
    const double now = square_error(plane, image);
    if (!(now < error)) {
      numbers_ = before;
      damping *= 30;
      continue;
    }
    const bool converged = error - now < kConverged * now;
    error = now;
    damping /= 10;
    if (converged) break;
  }
}

void LensMap::add_rest(std::span<const Pixel> plane, std::span<const Pixel> image, int degree) {
  std::vector<Pixel> places;
  Eigen::MatrixX2d lacks(static_cast<Eigen::Index>(plane.size()), 2);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    places.push_back(project(plane[i]));
    lacks.row(static_cast<Eigen::Index>(i)) =
        (vector_of(image[i]) - vector_of(places.back())).transpose();
  }
  rest_ = Polynomial(places, lacks, degree);
  double sum = 0;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    sum += (vector_of(image[i]) - vector_of(image_of(plane[i]))).squaredNorm();
  }
  misfit_ = std::sqrt(sum / static_cast<double>(plane.size()));
}

Pixel LensMap::image_of(const Pixel& p) const {
  const Pixel at = project(p);
  const Eigen::Vector2d rest = rest_.at(at);
  return {at.u + rest.x(), at.v + rest.y()};
}

std::optional<LensMap> LensMap::start(Projection projection, std::span<const Pixel> plane,
                                      std::span<const Pixel> image, const Pixel& middle,
                                      double scale, int degree) {
  constexpr double kWidest = 1.4;  // rad, of what a plane before the camera can show
  std::vector<Pixel> from;
  std::vector<Pixel> to;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    Eigen::Vector2d q = (vector_of(image[i]) - vector_of(middle)) / scale;
    if (projection == Projection::kEquidistant) {
      const double angle = q.norm();
      if (angle > kWidest) continue;
      q *= std::tan(angle) / std::max(angle, 1e-9);
    }
    from.push_back(plane[i]);
    to.push_back({q.x(), q.y()});
  }
  if (2 * from.size() < plane.size()) return std::nullopt;
  const auto h = fit_homography(from, to);
  if (!h || !(std::abs((*h)(2, 2)) > 1e-12)) return std::nullopt;
  LensMap map(projection, *h, middle, scale);
  map.improve(plane, image);
  if (!map.numbers_.allFinite()) return std::nullopt;
  map.add_rest(plane, image, degree);
  return map;
}

std::optional<LensMap> LensMap::fit(std::span<const Pixel> plane, std::span<const Pixel> image,
                                    const Pixel& middle, double sigma, int degree) {
  constexpr double kGood = 0.03;  // px
  constexpr double kSigmas = 2;   // of both coordinates, with room for chance
  const double good = std::max(kGood, kSigmas * sigma);
  const double half = std::max({middle.u, middle.v, 1.0});
  auto best = start(Projection::kPerspective, plane, image, middle, half, degree);
  if (best && best->misfit() < good) return best;
  // How far the middle of the longer side is from the axis, rad.
  for (const double angle : {1.57, 1.2, 0.8}) {
    auto other = start(Projection::kEquidistant, plane, image, middle, half / angle, degree);
    if (other && (!best || other->misfit() < best->misfit())) best = std::move(other);
    if (best && best->misfit() < good) break;
  }
  return best;
}

}  // namespace calvin::detect
