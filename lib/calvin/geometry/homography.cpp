// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fits a homography by the direct linear transform on normalised points (Hartley, In Defense of the
// Eight-Point Algorithm, PAMI 19(6), 1997).

#include "calvin/geometry/homography.hpp"

#include <cmath>

#include <Eigen/LU>

#include "calvin/geometry/symmetric.hpp"

namespace calvin {

namespace {

// The similarity that takes the points to centroid 0 and mean distance sqrt(2).
Eigen::Matrix3d normalisation(std::span<const Pixel> points) {
  const auto n = static_cast<double>(points.size());
  double mu = 0;
  double mv = 0;
  for (const Pixel& p : points) {
    mu += p.u / n;
    mv += p.v / n;
  }
  double distance = 0;
  for (const Pixel& p : points) distance += std::hypot(p.u - mu, p.v - mv) / n;
  const double s = std::sqrt(2.0) / distance;
  Eigen::Matrix3d t;
  t << s, 0, -s * mu, 0, s, -s * mv, 0, 0, 1;
  return t;
}

}  // namespace

Pixel transform(const Eigen::Matrix3d& h, Pixel point) noexcept {
  const Eigen::Vector3d p = h * Eigen::Vector3d(point.u, point.v, 1);
  return {p[0] / p[2], p[1] / p[2]};
}

Result<Eigen::Matrix3d> fit_homography(std::span<const Pixel> xy, std::span<const Pixel> uv) {
  if (xy.size() != uv.size() || xy.size() < 4) {
    return make_error(ErrorCode::kDegenerate, "A homography needs at least 4 point pairs.");
  }
  const Eigen::Matrix3d from = normalisation(xy);
  const Eigen::Matrix3d to = normalisation(uv);
  if (!from.allFinite() || !to.allFinite()) {
    return make_error(ErrorCode::kDegenerate, "All points of the view fall together.");
  }

  Eigen::Matrix<double, 9, 9> m = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < xy.size(); ++i) {
    const Pixel p = transform(from, xy[i]);
    const Pixel q = transform(to, uv[i]);
    Eigen::Matrix<double, 9, 1> a;
    Eigen::Matrix<double, 9, 1> b;
    a << p.u, p.v, 1, 0, 0, 0, -q.u * p.u, -q.u * p.v, -q.u;
    b << 0, 0, 0, p.u, p.v, 1, -q.v * p.u, -q.v * p.v, -q.v;
    m += a * a.transpose() + b * b.transpose();
  }
  const auto eigen = symmetric_eigen(m);
  // Collinear points leave more than one direction without support.
  if (!eigen || !(eigen->values[1] > 1e-10 * eigen->values[8])) {
    return make_error(ErrorCode::kDegenerate, "The points of the view lie on one line.");
  }
  const Eigen::Matrix<double, 9, 1> h = eigen->vectors.col(0);
  Eigen::Matrix3d normalised;
  normalised << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  Eigen::Matrix3d result = to.inverse() * normalised * from;
  if (std::abs(result(2, 2)) > 1e-12 * result.norm()) result /= result(2, 2);
  if (!result.allFinite()) return make_error(ErrorCode::kDegenerate, "The view has no homography.");
  return result;
}

}  // namespace calvin
