// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether the residuals of a fit are noise, as its covariance supposes. Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/solve/judge/contradiction.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/misfit.hpp"
#include "calvin/target/measured/board_pattern.hpp"

namespace calvin {

struct FitDiagnostics {
  // The projection difference of the solves of two halves of the views, a rotation of the camera
  // removed, over its predicted value: root mean square over the region that corners covered and
  // over all ways to halve the views. To first order at the optimum of all views: the covariance of
  // the halves has sum(g g^T) over the gradients of the views in place of sum(information).
  double split_half_ratio = 1;

  // Per view used: the weighted squares of its corners before a camera of all other views, px^2 per
  // corner, corrected for its own pose; to first order too. Infinite where the other views
  // determine no camera.
  std::vector<double> held_out;

  ChiSquare views;    // of the gradients of single views
  ChiSquare picture;  // of mean residuals in parts of the image: the lens is not of this model
  ChiSquare board;    // of mean residuals by corner, along the axes of its board

  // The covariance of the directions by what views say of them, whatever makes them say it, where
  // they contradict each other by more than noise lets them.
  std::optional<Eigen::MatrixXd> views_covariance;
  // How far corners are from where they were printed, m^2 along each axis of the board, 1 sigma;
  // 0 unless the views agree that they are.
  double board_variance = 0;
  std::optional<BoardPattern> board_pattern;  // of them, where they have one
  // The covariance of the directions were the board measured: with corners where all views together
  // see them. Absent where `board_variance` is 0.
  std::optional<Eigen::MatrixXd> board_known;
  double board_agrees = 0;    // standard deviations, see Agreement
  double picture_agrees = 0;  // the same for parts of the image
  bool bends_known = false;   // the curvatures of the board are unknowns of the fit
};

// `variance` is the variance of a residual of weight 1, px^2; `covariance` is over the unknowns;
// `covered` is over those of the camera.
// The result means nothing where `stop` was requested.
[[nodiscard]] FitDiagnostics diagnose(const Fit& fit, const Camera& camera, const BoardShape& shape,
                                      const Parameterization& parameterization,
                                      const PlacedGrid& covered, const Eigen::MatrixXd& covariance,
                                      double variance, const std::stop_token& stop);

// How much larger the variance of a board's measured points is than noise makes it, where views
// contradict each other.
[[nodiscard]] double board_excess(const FitDiagnostics& found);

// The covariance of all unknowns: of noise, or of what the views show of whatever there is; and of
// what a board that is not as printed does in all of them alike, or what is left unknown of a
// measured one. Each counts once. `variance` is that of a residual of weight 1, px^2.
[[nodiscard]] Eigen::MatrixXd honest_covariance(const Fit& fit, const BoardShape& shape,
                                                const Parameterization& parameterization,
                                                const FitDiagnostics& found,
                                                const Eigen::MatrixXd& by_noise, double variance);

}  // namespace calvin
