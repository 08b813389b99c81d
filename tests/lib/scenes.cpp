// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The error of an estimate in units of its predicted standard deviation.

#include "scenes.hpp"

#include <Eigen/Cholesky>

namespace calvin::scenes {

double normalised_error(const Calibration& calibration, const Camera& truth) {
  std::vector<double> error;
  for (std::size_t i = 0; i < truth.parameters().size(); ++i) {
    if (calibration.parameters[i].sigma) {
      error.push_back(calibration.parameters[i].value - truth.parameters()[i]);
    }
  }
  const auto n = static_cast<Eigen::Index>(error.size());
  const Eigen::MatrixXd c = Eigen::Map<const Eigen::MatrixXd>(calibration.covariance.data(), n, n);
  const Eigen::VectorXd e = Eigen::Map<const Eigen::VectorXd>(error.data(), n);
  const Eigen::VectorXd sigma = c.diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation =
      sigma.cwiseInverse().asDiagonal() * c * sigma.cwiseInverse().asDiagonal();
  const Eigen::VectorXd scaled = e.cwiseQuotient(sigma);
  return scaled.dot(correlation.ldlt().solve(scaled)) / static_cast<double>(n);
}

}  // namespace calvin::scenes
