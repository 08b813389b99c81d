// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a covariance says of the parameters, the board and the readout.

#include "calvin/solve/fit/add_estimates.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"
#include "calvin/target/measured/board_fields.hpp"

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

// Copies what modes of the board tell; `c` is over all unknowns.
void add_shape(Solution& solution, const Fit& fit, const ParameterTable& table,
               const Eigen::MatrixXd& c) {
  const auto value = [&](int unknown) { return fit.shared[static_cast<std::size_t>(unknown)]; };
  const auto sigma = [&](int unknown) { return std::sqrt(c(unknown, unknown)); };
  if (const ParameterRange warp = table.warp(0); !warp.empty()) {
    solution.calibration.warp =
        BoardWarp{value(warp[0]), value(warp[1]), sigma(warp[0]), sigma(warp[1])};
  }
  if (const ParameterRange aspect = table.aspect(0); !aspect.empty()) {
    solution.board_aspect = BoardAspect{1 + value(aspect[0]), sigma(aspect[0])};
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
                   const Eigen::MatrixXd& covariance) {
  add_sigmas(solution.calibration, table, covariance);
  add_shape(solution, fit, table, covariance);
  add_readout(solution.calibration, fit, table, covariance);
}

// The curvatures that are nearest to the offsets, and what is left of each point.
void add_board(Solution& solution, const Fit& fit, const BoardMeasurement& prior, double variance) {
  auto measured = std::make_shared<BoardMeasurement>(prior);
  measured->offsets = fit.board->offsets;
  measured->covariance = (fit.board->estimated ? variance : 1) * fit.board->covariance;
  const Eigen::MatrixXd basis = offset_basis(prior.board);
  const Eigen::MatrixXd fields =
      product(basis, transposed_product(basis, curvature_fields(prior.board)));
  const Eigen::MatrixXd to_bends =
      solve_symmetric(transposed_product(fields, fields), fields.transpose());
  Eigen::VectorXd offsets(fields.rows());
  for (std::size_t i = 0; i < measured->offsets.size(); ++i) {
    offsets.segment<3>(3 * static_cast<Eigen::Index>(i)) = measured->offsets[i];
  }
  const Eigen::VectorXd bends = to_bends * offsets;
  const Eigen::MatrixXd of_bends = congruent(measured->covariance, to_bends.transpose());
  solution.calibration.warp =
      BoardWarp{bends[0], bends[1], std::sqrt(of_bends(0, 0)), std::sqrt(of_bends(1, 1))};
  const Eigen::VectorXd left = offsets - fields * bends;
  const Eigen::MatrixXd by_bends = product(fields, to_bends);
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(left.size(), left.size()) - by_bends;
  const Eigen::VectorXd sigma =
      congruent(measured->covariance, rest.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Eigen::Index at = 0; at < left.size(); at += 3) {
    solution.corner_offsets.push_back({left.segment<3>(at), sigma.segment<3>(at)});
  }
  if (fit.board->estimated) solution.measured = std::move(measured);
}

}  // namespace calvin
