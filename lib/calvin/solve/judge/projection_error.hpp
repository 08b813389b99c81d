// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The error of projection that follows from a calibration's covariance. Internal.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/solve/judge/projection_grid.hpp"

namespace calvin {

// px, 1 sigma: the largest where corners covered the picture, and the largest anywhere in it.
struct Promise {
  double covered = 0;
  double anywhere = 0;  // no less than `covered`
  Pixel worst;          // where it is `anywhere`
};

// `covariance` is over the columns of the grids. Absent where it gives no number.
[[nodiscard]] std::optional<Promise> promise_of(const ProjectionGrids& grids,
                                                const Eigen::MatrixXd& covariance);

// The part of it that is the largest over one grid, px, 1 sigma.
[[nodiscard]] std::optional<double> error_over(const PlacedGrid& grid,
                                               const Eigen::MatrixXd& covariance);

// Of a calibration by its own covariance: see expected_error().
[[nodiscard]] std::optional<Promise> promise_of(const Calibration& calibration);

// "lower right", "left", "middle": where in the picture a pixel is.
[[nodiscard]] std::string part_of_picture(Pixel at, ImageSize size);

}  // namespace calvin
