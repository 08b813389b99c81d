// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether what a fit leaves over is noise: the promise of the covariance, checked. Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/fit.hpp"
#include "calvin/solve/misfit.hpp"

namespace calvin {

// A sum of squares that is `degrees` for noise alone, up to sqrt(2 degrees).
struct Excess {
  double sum = 0;
  double degrees = 0;

  // In standard deviations, by the cube root that makes chi^2 nearly normal (E. Wilson, M.
  // Hilferty, PNAS 17, 1931).
  [[nodiscard]] double deviations() const;
  // How much more variance there is than noise gives, 1 for noise.
  [[nodiscard]] double ratio() const { return degrees > 0 ? sum / degrees : 1; }
};

struct Consistency {
  // The projection difference of the solves of two halves of the views, a turn of the camera
  // removed, over its predicted value: root mean square over the image and over all ways to halve
  // the views. To first order, from what each view says of the camera by itself at the optimum of
  // all, which is sum(g g^T) in place of sum(information) in the covariance of the halves.
  double halves = 1;

  // Per view used: the weighted squares of its corners at a camera of all other views, px^2 per
  // corner, corrected for its own pose; to first order too. Infinite where the others tell no
  // camera.
  std::vector<double> held_out;

  Excess views;    // of what single views say of the unknowns
  Excess picture;  // of mean residuals in parts of the image: a lens that is not the model's
  Excess board;    // of mean residuals by corner, along the axes of its board
};

// `variance` is that of a residual of weight 1, px^2; `covariance` that of the unknowns. Means
// nothing where `stop` was requested.
[[nodiscard]] Consistency consistency(const Fit& fit, const Camera& camera, const BoardShape& shape,
                                      const Freedom& freedom, const Eigen::MatrixXd& covariance,
                                      double variance, const std::stop_token& stop);

// The verdict. `chi` is absent where the detector told no sigma; `rms` is that of the corners, px.
[[nodiscard]] Misfit misfit(const Consistency& consistency, std::optional<double> chi,
                            double degrees, double rms);

}  // namespace calvin
