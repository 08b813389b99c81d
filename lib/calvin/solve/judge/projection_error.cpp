// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The covariance of a calibration as an error of projection.

#include "calvin/solve/judge/projection_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calvin/camera/camera.hpp"

namespace calvin {

namespace {

struct Worst {
  double variance = 0;  // px^2
  Pixel at;
};

Worst worst_of(const PlacedGrid& grid, const Eigen::MatrixXd& covariance) {
  const PlacedVariances of_places = variances(grid, covariance);
  Worst worst;
  for (std::size_t i = 0; i < grid.at.size(); ++i) {
    const double variance = of_places.largest(static_cast<Eigen::Index>(i));
    if (i == 0 || variance > worst.variance) worst = {variance, grid.at[i]};
  }
  return worst;
}

// px. An error that is as large as the picture says that nothing is known; a larger one, of a
// variance that is far beyond where it is linear, says no more.
double error_of(double variance, const PlacedGrid& picture) {
  double diagonal = 0;
  for (const Pixel& at : picture.at) diagonal = std::max(diagonal, std::hypot(at.u, at.v));
  return std::min(std::sqrt(std::max(variance, 0.0)), diagonal);
}

}  // namespace

std::optional<Promise> promise_of(const ProjectionGrids& grids, const Eigen::MatrixXd& covariance) {
  if (grids.picture.at.empty() || !covariance.allFinite()) return std::nullopt;
  const Worst covered = worst_of(grids.covered, covariance);
  Worst anywhere = worst_of(grids.picture, covariance);
  if (anywhere.variance < covered.variance) anywhere = covered;
  if (!std::isfinite(anywhere.variance) || !std::isfinite(covered.variance)) return std::nullopt;
  return Promise{error_of(covered.variance, grids.picture),
                 error_of(anywhere.variance, grids.picture), anywhere.at};
}

std::optional<double> error_over(const PlacedGrid& grid, const Eigen::MatrixXd& covariance) {
  if (grid.at.empty() || !covariance.allFinite()) return std::nullopt;
  const double variance = worst_of(grid, covariance).variance;
  if (!std::isfinite(variance)) return std::nullopt;
  return std::sqrt(std::max(variance, 0.0));
}

std::optional<Promise> promise_of(const Calibration& calibration) {
  const auto camera = Camera::make(calibration);
  const auto columns = estimated_columns(calibration);
  if (!camera || !columns || columns->empty() ||
      calibration.covariance.size() != columns->size() * columns->size()) {
    return std::nullopt;
  }
  const auto n = static_cast<Eigen::Index>(columns->size());
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return promise_of(projection_grids(*camera, *columns, calibration.covered),
                    Eigen::Map<const RowMajor>(calibration.covariance.data(), n, n));
}

std::string part_of_picture(Pixel at, ImageSize size) {
  constexpr std::array kRows = {"top", "", "bottom"};
  constexpr std::array kColumns = {"left", "", "right"};
  const auto third = [](double x, int extent) {
    return static_cast<std::size_t>(std::clamp(std::floor(3 * (x + 0.5) / extent), 0.0, 2.0));
  };
  const std::size_t row = third(at.v, size.height);
  const std::size_t column = third(at.u, size.width);
  if (row == 1 && column == 1) return "middle";
  if (row == 1) return kColumns[column];
  if (column == 1) return kRows[row];
  return std::string(row == 0 ? "upper " : "lower ") + kColumns[column];
}

}  // namespace calvin
