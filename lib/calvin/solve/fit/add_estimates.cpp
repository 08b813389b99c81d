// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a covariance says of the parameters, the board and the readout.

#include "calvin/solve/fit/add_estimates.hpp"

#include <cmath>

#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"

namespace calvin {

namespace {

// Copies sigmas and covariance of the parameters; `c` is over all unknowns.
void add_sigmas(Calibration& calibration, const ParameterTable& table, const Eigen::MatrixXd& c) {
  const ParameterRange own = table.camera(0);
  for (int i = 0; i < own.count; ++i) {
    const int row = own[i];
    if (table.held(row)) continue;
    calibration.parameters[static_cast<std::size_t>(i)].sigma = std::sqrt(c(row, row));
    for (int column = own.first; column < own.end(); ++column) {
      if (!table.held(column)) calibration.covariance.push_back(c(row, column));
    }
  }
}

// Copies the measured shape of the board; `c` is over all unknowns.
void add_shape(Solution& solution, const Fit& fit, const ParameterTable& table,
               const BoardShape& shape, const Eigen::MatrixXd& c) {
  const auto value = [&](int unknown) { return fit.shared[static_cast<std::size_t>(unknown)]; };
  const auto sigma = [&](int unknown) { return std::sqrt(c(unknown, unknown)); };
  if (const ParameterRange warp = table.warp(0); !warp.empty()) {
    solution.calibration.warp =
        BoardWarp{value(warp[0]), value(warp[1]), sigma(warp[0]), sigma(warp[1])};
  }
  if (const ParameterRange aspect = table.aspect(0); !aspect.empty()) {
    solution.board_aspect = BoardAspect{1 + value(aspect[0]), sigma(aspect[0])};
  }
  const ParameterRange offsets = table.offsets(0);
  if (offsets.empty()) return;
  const auto first = static_cast<std::size_t>(shape.unknowns.offsets().first);
  const auto own = values_of(fit.shared, offsets);
  const Eigen::Map<const Eigen::VectorXd> values(own.data(), offsets.count);
  const Eigen::MatrixXd covariance =
      c.block(offsets.first, offsets.first, offsets.count, offsets.count);
  for (std::size_t i = 0; i < shape.displacement.size() / shape.modes; ++i) {
    Eigen::MatrixXd moves(3, offsets.count);
    for (Eigen::Index m = 0; m < offsets.count; ++m) {
      moves.col(m) = shape.displacement[i * shape.modes + first + static_cast<std::size_t>(m)];
    }
    const Eigen::MatrixXd by_covariance = product(moves, covariance);
    solution.corner_offsets.push_back(
        {moves * values, by_covariance.cwiseProduct(moves).rowwise().sum().cwiseSqrt()});
  }
}

// Copies what was found of the readout; `c` is over all unknowns.
void add_readout(Calibration& calibration, const Fit& fit, const ParameterTable& table,
                 const Eigen::MatrixXd& c) {
  const ParameterRange readout = table.readout(0);
  if (readout.empty()) return;
  calibration.readout = table.readout_at(0, fit.shared);
  if (!table.held(readout.first)) {
    calibration.readout_sigma = std::sqrt(c(readout.first, readout.first));
  }
}

}  // namespace

void add_estimates(Solution& solution, const Fit& fit, const ParameterTable& table,
                   const BoardShape& shape, const Eigen::MatrixXd& covariance) {
  add_sigmas(solution.calibration, table, covariance);
  add_shape(solution, fit, table, shape, covariance);
  add_readout(solution.calibration, fit, table, covariance);
}

}  // namespace calvin
