// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The statistics of a solve from their definitions: every derivative is a central difference of
// Camera::project(), every matrix is whole. Nothing of lib/calvin/solve takes part.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin::dense {

// How a mode moves the point with an id, m per unit of its coefficient.
using Mode = std::vector<Eigen::Vector3d>;

struct Prior {
  Eigen::Index unknown = 0;
  double value = 0;
  double sigma = 1;
};

// The unknowns beside the poses: the parameters in the model's order, the skew where it is
// estimated, the coefficients of the modes.
struct Unknowns {
  std::string model;
  ImageSize size;
  std::vector<double> parameters;
  double skew = 0;
  bool has_skew = false;
  std::vector<Mode> modes;
  std::vector<double> shape;   // the coefficient of each mode
  Eigen::MatrixXd directions;  // in which the unknowns move; empty: each by itself
  std::vector<Prior> priors;

  [[nodiscard]] Eigen::Index of_camera() const {
    return static_cast<Eigen::Index>(parameters.size()) + (has_skew ? 1 : 0);
  }
  [[nodiscard]] Eigen::Index count() const {
    return of_camera() + static_cast<Eigen::Index>(modes.size());
  }
  [[nodiscard]] Eigen::MatrixXd basis() const {
    return directions.size() > 0 ? directions : Eigen::MatrixXd::Identity(count(), count());
  }
  [[nodiscard]] double at(Eigen::Index i) const {
    const auto k = static_cast<std::size_t>(i);
    if (k < parameters.size()) return parameters[k];
    if (i < of_camera()) return skew;
    return shape[static_cast<std::size_t>(i - of_camera())];
  }
  // The camera with one of its unknowns moved.
  [[nodiscard]] Camera camera(Eigen::Index moved = 0, double step = 0) const {
    std::vector<double> p = parameters;
    double s = skew;
    (moved < static_cast<Eigen::Index>(p.size()) ? p[static_cast<std::size_t>(moved)] : s) += step;
    return Camera::make(model, size, p, s).value();
  }
  [[nodiscard]] double step(Eigen::Index i) const {
    return i < 4 || i >= static_cast<Eigen::Index>(parameters.size()) ? 1e-3 : 1e-6;
  }
};

// What one view says of the unknowns where its pose takes the step that suits it best.
struct ViewSums {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double cost = 0;
};

// One view: residuals over sigma, and their derivatives by the unknowns and by the pose.
struct Rows {
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_unknowns;
  Eigen::MatrixXd by_pose;
};

inline Eigen::Vector2d seen(const Camera& camera, const Eigen::Vector3d& point) {
  const Pixel at = camera.project(point).value();
  return {at.u, at.v};
}

inline Rows rows_of(const Unknowns& u, const View& view, const SE3& pose, bool sigmas) {
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

// The pose taken out: what is left is seen across all that a pose can do.
inline ViewSums sums_of(const Rows& rows, const Eigen::MatrixXd& basis) {
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(rows.by_pose).householderQ() *
                            Eigen::MatrixXd::Identity(rows.by_pose.rows(), 6);
  const Eigen::MatrixXd a = rows.by_unknowns * basis;
  const Eigen::MatrixXd left = a - q * (q.transpose() * a);
  return {left.transpose() * left, left.transpose() * rows.residual, rows.residual.squaredNorm()};
}

// The whole solve at a point that is its optimum.
struct Solve {
  std::vector<ViewSums> views;
  Eigen::MatrixXd information;  // over the directions, with the priors
  double cost = 0;              // with the priors
  double corners_cost = 0;
  double degrees = 0;  // of all of the cost: corners and priors less unknowns
  // Of the corners alone: what priors tell is not fitted to them. It is the trace of the priors'
  // information times the covariance of all.
  double corners_degrees = 0;

  // `sigmas`: whether those of the corners are believed, else each is 1 px.
  Solve(const Unknowns& u, const std::vector<View>& seen, const std::vector<SE3>& poses,
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
  [[nodiscard]] Eigen::MatrixXd inverse() const {
    const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  }
};

// At each pixel of a grid of 33x25 from border to border: the derivative of the projection of its
// ray by the camera's unknowns, less the best rotation common to all of them.
inline std::vector<Eigen::MatrixXd> grid_of(const Unknowns& u,
                                            const std::vector<Pixel>& covered = {}) {
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
  const Eigen::MatrixXd left =
      by_unknowns - by_turn * by_turn.colPivHouseholderQr().solve(by_unknowns);
  std::vector<Eigen::MatrixXd> grid;
  for (Eigen::Index i = 0; i < n; ++i) grid.emplace_back(left.middleRows<2>(2 * i));
  return grid;
}

// 1 sigma along the worse direction at the worst pixel of the grid; `covariance` is over the
// camera's unknowns.
inline double worst_of(const std::vector<Eigen::MatrixXd>& grid,
                       const Eigen::MatrixXd& covariance) {
  double worst = 0;
  for (const Eigen::MatrixXd& cell : grid) {
    const Eigen::Matrix2d spread = cell * covariance * cell.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(spread, Eigen::EigenvaluesOnly);
    worst = std::max(worst, eigen.eigenvalues()[1]);
  }
  return std::sqrt(worst);
}

}  // namespace calvin::dense
