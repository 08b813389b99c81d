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
#include "calvin/solve/judge/projection_grid.hpp"
#include "calvin/solve/misfit.hpp"

namespace calvin {

// A chi^2 statistic: a sum of squares that for noise alone is `degrees`, give or take
// sqrt(2 degrees).
struct ChiSquare {
  double sum = 0;
  double degrees = 0;

  // The excess in standard deviations, by the cube root that makes chi^2 nearly normal (E. Wilson,
  // M. Hilferty, PNAS 17, 1931).
  [[nodiscard]] double deviations() const;
  // The variance over that of noise: 1 for noise.
  [[nodiscard]] double ratio() const { return degrees > 0 ? sum / degrees : 1; }
};

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
};

// `variance` is the variance of a residual of weight 1, px^2; `covariance` is over the unknowns;
// `covered` is over those of the camera.
// The result means nothing where `stop` was requested.
[[nodiscard]] FitDiagnostics diagnose(const Fit& fit, const Camera& camera, const BoardShape& shape,
                                      const Parameterization& parameterization,
                                      const ProjectionGrid& covered,
                                      const Eigen::MatrixXd& covariance, double variance,
                                      const std::stop_token& stop);

// The verdict. `chi` is absent where the detector gave no sigmas; `degrees` are the degrees of
// freedom of the fit, `rms` its residual, px.
[[nodiscard]] Misfit misfit(const FitDiagnostics& diagnostics, std::optional<double> chi,
                            double degrees, double rms);

}  // namespace calvin
