// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The derivatives and sums of dense_solve.hpp, compiled once: dense products take seconds each.

#include "dense_solve.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/dense.hpp"

namespace calvin::dense {

namespace {

Eigen::Vector2d seen(const Camera& camera, const Eigen::Vector3d& point) {
  const Pixel at = camera.project(point).value();
  return {at.u, at.v};
}

}  // namespace

Eigen::MatrixXd without(const Eigen::MatrixXd& taken, const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(taken).householderQ() *
                            Eigen::MatrixXd::Identity(taken.rows(), taken.cols());
  return a - product(q, transposed_product(q, a));
}

Rows rows_of(const Unknowns& u, const View& view, const SE3& pose, bool sigmas) {
  const Observation& o = view.observation;
  const auto printed = view.board.points();
  const auto n = static_cast<Eigen::Index>(o.ids.size());
  Rows rows = {Eigen::VectorXd(2 * n), Eigen::MatrixXd(2 * n, u.count()),
               Eigen::MatrixXd(2 * n, 6)};
  const Camera camera = u.camera();
  std::vector<Camera> up;
  std::vector<Camera> down;
  for (Eigen::Index k = 0; k < u.of_camera(); ++k) {
    up.push_back(u.camera(k, u.step(k)));
    down.push_back(u.camera(k, -u.step(k)));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto c = static_cast<std::size_t>(i);
    const auto id = static_cast<std::size_t>(o.ids[c]);
    const double w = sigmas ? 1 / o.sigma[c] : 1;
    Eigen::Vector3d point = printed[id];
    for (std::size_t m = 0; m < u.modes.size(); ++m) point += u.shape[m] * u.modes[m][id];
    const Eigen::Vector3d p = pose * point;
    const Eigen::Vector2d uv(o.uv[c].u, o.uv[c].v);
    rows.residual.segment<2>(2 * i) = w * (seen(camera, p) - uv);
    for (Eigen::Index k = 0; k < u.of_camera(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      rows.by_unknowns.block<2, 1>(2 * i, k) =
          w * (seen(up[at], p) - seen(down[at], p)) / (2 * u.step(k));
    }
    const double h = 1e-6 * p.norm();
    Eigen::Matrix<double, 2, 3> by_point;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(k);
      by_point.col(k) = w * (seen(camera, p + d) - seen(camera, p - d)) / (2 * h);
    }
    for (std::size_t m = 0; m < u.modes.size(); ++m) {
      rows.by_unknowns.block<2, 1>(2 * i, u.of_camera() + static_cast<Eigen::Index>(m)) =
          by_point * pose.rotation * u.modes[m][id];
    }
    for (int k = 0; k < 3; ++k) {
      rows.by_pose.block<2, 1>(2 * i, k) = by_point * Eigen::Vector3d::Unit(k).cross(p);
      rows.by_pose.block<2, 1>(2 * i, 3 + k) = by_point.col(k);
    }
  }
  return rows;
}

ViewSums sums_of(const Rows& rows, const Eigen::MatrixXd& basis) {
  const Eigen::MatrixXd left = without(rows.by_pose, product(rows.by_unknowns, basis));
  return {transposed_product(left, left), transposed_product(left, rows.residual),
          rows.residual.squaredNorm()};
}

Solve::Solve(const Unknowns& u, const std::vector<View>& seen, const std::vector<SE3>& poses,
             bool sigmas) {
  const Eigen::MatrixXd basis = u.basis();
  information = Eigen::MatrixXd::Zero(basis.cols(), basis.cols());
  degrees = -static_cast<double>(basis.cols());
  for (std::size_t v = 0; v < seen.size(); ++v) {
    views.push_back(sums_of(rows_of(u, seen[v], poses[v], sigmas), basis));
    information += views.back().information;
    corners_cost += views.back().cost;
    degrees += 2 * static_cast<double>(seen[v].observation.ids.size()) - 6;
  }
  cost = corners_cost;
  for (const Prior& prior : u.priors) {
    const Eigen::VectorXd row = basis.row(prior.unknown);
    information += row * row.transpose() / (prior.sigma * prior.sigma);
    cost += std::pow((u.at(prior.unknown) - prior.value) / prior.sigma, 2);
  }
  corners_degrees = degrees;
  degrees += static_cast<double>(u.priors.size());
  const Eigen::MatrixXd covariance = inverse();
  for (const Prior& prior : u.priors) {
    const Eigen::VectorXd row = basis.row(prior.unknown);
    corners_degrees += row.dot(covariance * row) / (prior.sigma * prior.sigma);
  }
}
Eigen::MatrixXd Solve::inverse() const {
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
}

std::vector<Eigen::MatrixXd> grid_of(const Unknowns& u, const std::vector<Pixel>& covered) {
  constexpr int kColumns = 33;
  constexpr int kRows = 25;
  const Camera camera = u.camera();
  std::vector<Eigen::Vector3d> rays;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const Pixel at = {x * (u.size.width - 1.0) / (kColumns - 1),
                        y * (u.size.height - 1.0) / (kRows - 1)};
      if (!covered.empty() && !contains(covered, at)) continue;
      const auto ray = camera.unproject(at);
      if (ray) rays.push_back(*ray);
    }
  }
  for (const Pixel& corner : covered) {
    if (const auto ray = camera.unproject(corner)) rays.push_back(*ray);
  }
  const auto n = static_cast<Eigen::Index>(rays.size());
  Eigen::MatrixXd by_unknowns(2 * n, u.of_camera());
  Eigen::MatrixXd by_turn(2 * n, 3);
  for (Eigen::Index k = 0; k < u.of_camera(); ++k) {
    const Camera up = u.camera(k, u.step(k));
    const Camera down = u.camera(k, -u.step(k));
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Vector3d& ray = rays[static_cast<std::size_t>(i)];
      by_unknowns.block<2, 1>(2 * i, k) = (seen(up, ray) - seen(down, ray)) / (2 * u.step(k));
    }
  }
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = 1e-6 * Eigen::Vector3d::Unit(k);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Vector3d& ray = rays[static_cast<std::size_t>(i)];
      by_turn.block<2, 1>(2 * i, k) =
          (seen(camera, exp_so3(d) * ray) - seen(camera, exp_so3(-d) * ray)) / 2e-6;
    }
  }
  const Eigen::MatrixXd left = without(by_turn, by_unknowns);
  std::vector<Eigen::MatrixXd> grid;
  for (Eigen::Index i = 0; i < n; ++i) grid.emplace_back(left.middleRows<2>(2 * i));
  return grid;
}

double worst_of(const std::vector<Eigen::MatrixXd>& grid, const Eigen::MatrixXd& covariance) {
  double worst = 0;
  for (const Eigen::MatrixXd& cell : grid) {
    const Eigen::Matrix2d spread = congruent(covariance, cell.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(spread, Eigen::EigenvaluesOnly);
    worst = std::max(worst, eigen.eigenvalues()[1]);
  }
  return std::sqrt(worst);
}

}  // namespace calvin::dense
