// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/start.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "calvin/geometry/homography.hpp"

namespace calvin {

namespace {

// Focal lengths outside of this, in image widths, are no camera's.
constexpr double kShortest = 0.1;
constexpr double kLongest = 30;

// The homography board -> px of one view. Corners far off the first fit are left out of further
// ones: one gross corner must not spoil a view.
std::optional<Eigen::Matrix3d> view_homography(const PointSet& view) {
  std::vector<Pixel> xy;
  for (const Eigen::Vector3d& p : view.points) xy.push_back({p.x(), p.y()});
  std::vector<Pixel> uv = view.uv;
  for (int round = 0; round < 4; ++round) {
    const auto h = fit_homography(xy, uv);
    if (!h) return std::nullopt;
    std::vector<double> distance;
    for (std::size_t i = 0; i < xy.size(); ++i) {
      const Pixel at = transform(*h, xy[i]);
      distance.push_back(std::hypot(at.u - uv[i].u, at.v - uv[i].v));
    }
    std::vector<double> sorted = distance;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(xy.size() / 2),
                     sorted.end());
    const double limit = 5 * sorted[xy.size() / 2] + 1e-6;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < xy.size(); ++i) {
      if (!(distance[i] <= limit)) continue;
      xy[kept] = xy[i];
      uv[kept++] = uv[i];
    }
    if (kept == xy.size() || kept < 4) return *h;
    xy.resize(kept);
    uv.resize(kept);
  }
  const auto h = fit_homography(xy, uv);
  if (!h) return std::nullopt;
  return *h;
}

bool possible(const Guess& g, ImageSize size) {
  const auto focal = [size](double f) {
    return f > kShortest * size.width && f < kLongest * size.width;
  };
  return focal(g[0]) && focal(g[1]) && std::max(g[0], g[1]) < 2 * std::min(g[0], g[1]) &&
         g[2] > 0 && g[2] < size.width && g[3] > 0 && g[3] < size.height;
}

// Zhang 2000, section 3.1 and appendix B, with zero skew: the image of the absolute conic
// b = (B11, B22, B13, B23, B33) is orthogonal to two rows per view.
std::optional<Guess> zhang(std::span<const Eigen::Matrix3d> homographies) {
  Eigen::Matrix<double, 5, 5> m = Eigen::Matrix<double, 5, 5>::Zero();
  for (const Eigen::Matrix3d& h : homographies) {
    const auto row = [&h](int i, int j) {
      Eigen::Matrix<double, 5, 1> v;
      v << h(0, i) * h(0, j), h(1, i) * h(1, j), h(0, i) * h(2, j) + h(2, i) * h(0, j),
          h(1, i) * h(2, j) + h(2, i) * h(1, j), h(2, i) * h(2, j);
      return v;
    };
    const double norm = h.col(0).head<2>().squaredNorm() + h.col(1).head<2>().squaredNorm();
    const Eigen::Matrix<double, 5, 1> orthogonal = row(0, 1) / norm;
    const Eigen::Matrix<double, 5, 1> equal = (row(0, 0) - row(1, 1)) / norm;
    m += orthogonal * orthogonal.transpose() + equal * equal.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 5, 5>> eigen(m);
  Eigen::Matrix<double, 5, 1> b = eigen.eigenvectors().col(0);
  if (b[0] < 0) b = -b;
  const double lambda = b[4] - b[2] * b[2] / b[0] - b[3] * b[3] / b[1];
  if (!(b[0] > 0) || !(b[1] > 0) || !(lambda > 0)) return std::nullopt;
  return Guess{std::sqrt(lambda / b[0]), std::sqrt(lambda / b[1]), -b[2] / b[0], -b[3] / b[1]};
}

// a / b = f^2 for the two orthogonal pairs of directions of a board seen in one view (J.-Y.
// Bouguet, Camera Calibration Toolbox; the vanishing points of the sides and of the diagonals).
struct FocalEquation {
  double a = 0;
  double b = 0;
  [[nodiscard]] std::optional<double> focal() const {
    if (!(a * b > 0)) return std::nullopt;
    return std::sqrt(a / b);
  }
};

FocalEquation focal_equation(const Eigen::Matrix3d& h) {
  FocalEquation sum;
  const auto add = [&sum](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    const double norm = p.norm() * q.norm();
    const double a = (p[0] * q[0] + p[1] * q[1]) / norm;
    const double b = -p[2] * q[2] / norm;
    sum.a += a * b;
    sum.b += b * b;
  };
  add(h.col(0), h.col(1));
  add((h.col(0) + h.col(1)) / 2, (h.col(0) - h.col(1)) / 2);
  return sum;
}

}  // namespace

std::vector<Guess> closed_form_guesses(std::span<const PointSet> views, ImageSize size) {
  // Coordinates from the centre in image widths keep all numbers near 1.
  const Pixel center = image_center(size);
  const double width = size.width;
  Eigen::Matrix3d to_unit;
  to_unit << 1 / width, 0, -center.u / width, 0, 1 / width, -center.v / width, 0, 0, 1;
  std::vector<Eigen::Matrix3d> homographies;
  for (const PointSet& view : views) {
    if (const auto h = view_homography(view)) homographies.push_back(to_unit * *h);
  }

  std::vector<Guess> guesses;
  const auto offer = [&](const Guess& unit) {
    const Guess g = {unit[0] * width, unit[1] * width, unit[2] * width + center.u,
                     unit[3] * width + center.v};
    if (possible(g, size)) guesses.push_back(g);
  };
  if (homographies.size() >= 3) {
    if (const auto guess = zhang(homographies)) offer(*guess);
  }
  FocalEquation all;
  std::vector<double> single;
  for (const Eigen::Matrix3d& h : homographies) {
    const FocalEquation equation = focal_equation(h);
    all.a += equation.a;
    all.b += equation.b;
    if (const auto f = equation.focal()) single.push_back(*f);
  }
  if (const auto f = all.focal()) offer({*f, *f, 0, 0});
  if (!single.empty()) {
    const auto middle = single.begin() + static_cast<std::ptrdiff_t>(single.size() / 2);
    std::nth_element(single.begin(), middle, single.end());
    offer({*middle, *middle, 0, 0});
  }
  return guesses;
}

std::vector<Guess> focal_grid(ImageSize size, bool perspective) {
  const Pixel center = image_center(size);
  std::vector<Guess> guesses;
  for (const double widths : {0.16, 0.2, 0.25, 0.32, 0.42, 0.6, 0.9, 1.4, 2.2, 4.0, 8.0}) {
    if (perspective && widths < 0.3) continue;
    const double f = widths * size.width;
    guesses.push_back({f, f, center.u, center.v});
  }
  return guesses;
}

}  // namespace calvin
