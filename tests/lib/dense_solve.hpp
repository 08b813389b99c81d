// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The statistics of a solve from their definitions: every derivative is a central difference of
// Camera::project(), every matrix is whole. Nothing of lib/calvin/solve takes part.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
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

// What is left of the columns of `a` across those of `taken`, which are independent.
[[nodiscard]] Eigen::MatrixXd without(const Eigen::MatrixXd& taken, const Eigen::MatrixXd& a);

// One view: residuals over sigma, and their derivatives by the unknowns and by the pose.
struct Rows {
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_unknowns;
  Eigen::MatrixXd by_pose;
};

// `sigmas`: whether those of the corners are believed, else each is 1 px.
[[nodiscard]] Rows rows_of(const Unknowns& u, const View& view, const SE3& pose, bool sigmas);

// The pose taken out: what is left is seen across all that a pose can do.
[[nodiscard]] ViewSums sums_of(const Rows& rows, const Eigen::MatrixXd& basis);

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

  // `sigmas`: as of rows_of().
  Solve(const Unknowns& u, const std::vector<View>& seen, const std::vector<SE3>& poses,
        bool sigmas);
  [[nodiscard]] Eigen::MatrixXd inverse() const;
};

// At each pixel of a grid of 33x25 from border to border: the derivative of the projection of its
// ray by the camera's unknowns, less the best rotation common to all of them. With `covered` those
// inside of that hull, and its corners.
[[nodiscard]] std::vector<Eigen::MatrixXd> grid_of(const Unknowns& u,
                                                   const std::vector<Pixel>& covered = {});

// 1 sigma along the worse direction at the worst pixel of the grid; `covariance` is over the
// camera's unknowns.
[[nodiscard]] double worst_of(const std::vector<Eigen::MatrixXd>& grid,
                              const Eigen::MatrixXd& covariance);

}  // namespace calvin::dense
