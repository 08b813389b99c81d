// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The least squares for one camera, from its start to its last iteration. Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin {

// An optimum that is not the best one.
struct Rival {
  std::vector<double> shared;
  double cost = 0;  // px^2
};

// The places of a board's points where they are not those of the printed board: estimated, or known
// from others. What is left unknown of them adds to the covariance of the directions, whose
// `information` supposes that the points are known.
struct FittedBoard {
  bool estimated = false;                // then covariances are for residuals of a variance of 1
  std::vector<Eigen::Vector3d> offsets;  // m
  Eigen::MatrixXd covariance;            // m^2, of x y z of one point after the other
  Eigen::MatrixXd of_directions;         // what it adds
  double determined = 0;  // how many of the numbers the views determine, not the prior
};

struct Fit {
  std::vector<double> shared;                // in the order of the table
  std::vector<SE3> camera_from_board;        // per view; valid for the views used
  std::vector<PointSet> views;               // corners left out have weight 0
  std::vector<bool> used;                    // per view
  std::vector<std::vector<double>> squares;  // per view used: each corner's squared distance, px^2
  double cost = 0;                           // weighted, px^2, over the corners used
  Eigen::MatrixXd information;  // over Parameterization's directions, for residuals of 1 px
  std::optional<FittedBoard> board;
  std::vector<Rival> rivals;
  int iterations = 0;
  bool converged = false;
  bool sound = false;  // converged to a camera that is determined and sees all corners used
  bool cancelled = false;
};

// The best fit found; not converged where the data do not lead anywhere. The modes of the shape
// are those of the board of the parameterization.
[[nodiscard]] Fit fit_camera(std::vector<PointSet> views, const BoardShape& shape, ImageSize size,
                             const Parameterization& parameterization, const SolveOptions& options,
                             const std::stop_token& stop);

}  // namespace calvin
