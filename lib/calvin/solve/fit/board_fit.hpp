// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The places of a board's points as unknowns beside camera and poses. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/target/measured/board_measurement.hpp"

namespace calvin {

// The optimum over offsets, camera and poses by variable projection (G. Golub, V. Pereyra, SIAM J.
// Numer. Anal. 10(2), 1973): the offsets take Gauss-Newton steps between fits of camera and poses
// to points that stand still, each step allowing for what camera and poses do then. Offsets are far
// smaller than a board is large, so that a step or two are enough.
//
// Views that may be labelled otherwise tell nothing of offsets, and see the curvatures of the board
// alone, which a board that is turned by half a turn shows as well.
class BoardFit {
 public:
  // From the offsets of the prior, or from a board that is bent like this.
  explicit BoardFit(const BoardMeasurement& prior);
  BoardFit(const BoardMeasurement& prior, const BoardWarp& start);

  // Puts the points of views where the offsets are by now, at the height of BoardWarp.
  void place(std::vector<PointSet>& views) const;

  // Takes the equations of a fit to points that were placed so. False where the fit determines no
  // camera.
  [[nodiscard]] bool linearise(const Fit& fit, const BoardShape& shape,
                               const Parameterization& parameterization);

  // Finds the next step by these equations and the prior, where a residual of weight 1 has `sigma`
  // px, and returns by how much it lessens the cost, px^2. Absent where there is none.
  [[nodiscard]] std::optional<double> find_step(double sigma);
  void take_step();

  // Whether the views contradict the prior, at whose offsets the equations were taken: the board is
  // another one, or bent otherwise.
  [[nodiscard]] bool contradicts_prior() const;

  // The board with its offsets as the step that was found leaves them, or as the prior has them.
  [[nodiscard]] FittedBoard fitted() const;
  [[nodiscard]] FittedBoard known() const;

 private:
  const BoardMeasurement& prior_;
  std::vector<Eigen::Vector3d> printed_;
  Eigen::MatrixXd basis_;              // of all offsets, 3 numbers of each point
  Eigen::MatrixXd curvatures_;         // in the basis
  Eigen::MatrixXd prior_covariance_;   // in the basis, m^2
  Eigen::MatrixXd prior_information_;  // its inverse, once there is a step to find
  Eigen::VectorXd offsets_;            // 3 numbers of each point, m

  // The equations, camera and poses eliminated, in the basis.
  Eigen::MatrixXd information_;  // by the views
  Eigen::MatrixXd whole_;        // with the prior
  Eigen::VectorXd gradient_;     // by the views
  Eigen::VectorXd step_;
  Eigen::MatrixXd moves_;  // of the directions with the offsets
  double cost_ = 0;        // px^2
  double degrees_ = 0;     // of the cost, the offsets not allowed for
  double variance_ = 1;    // px^2, of a residual of weight 1 as the step has it
};

}  // namespace calvin
