// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The covariance of a calibration as an error of projection.

#include "calvin/solve/judge/projection_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/judge/projection_grid.hpp"

namespace calvin {

std::optional<double> projection_error(const Calibration& calibration) {
  const auto camera = Camera::make(calibration);
  const auto columns = estimated_columns(calibration);
  if (!camera || !columns || columns->empty() ||
      calibration.covariance.size() != columns->size() * columns->size()) {
    return std::nullopt;
  }
  const auto n = static_cast<Eigen::Index>(columns->size());
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd covariance =
      Eigen::Map<const RowMajor>(calibration.covariance.data(), n, n);
  if (!covariance.allFinite()) return std::nullopt;
  const ProjectionGrid grid = projection_grid(*camera, *columns);
  if (grid.empty()) return std::nullopt;
  double variance = 0;
  for (const auto& cell : grid) {
    const ProjectionGrid::value_type by_covariance = cell.lazyProduct(covariance);
    variance = std::max(variance, larger_eigenvalue(by_covariance.lazyProduct(cell.transpose())));
  }
  const double error = std::sqrt(variance);
  if (!std::isfinite(error)) return std::nullopt;
  return error;
}

}  // namespace calvin
