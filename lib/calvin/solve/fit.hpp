// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The least squares for one camera model. Each model is compiled in a file of its own, which
// meson.build makes from fit_model.cpp.in. Internal.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"
#include "calvin/solve/freedom.hpp"
#include "calvin/solve/loss.hpp"
#include "calvin/solve/points.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

// What comes out, for any model.
struct Fit {
  std::vector<double> parameters;
  std::vector<SE3> camera_from_board;  // per view; of those used
  std::vector<PointSet> views;         // corners left out have weight 0
  std::vector<bool> used;              // per view
  double cost = 0;                     // weighted, px^2, over the corners used
  Eigen::MatrixXd information;         // over Freedom's directions, for residuals of 1 px
  int iterations = 0;
  bool converged = false;
  bool cancelled = false;
};

// M is a Model of models.hpp. The best fit found; not converged where the data do not lead
// anywhere.
template <typename M>
[[nodiscard]] Fit fit_model(std::vector<PointSet> views, ImageSize size, const Freedom& freedom,
                            const SolveOptions& options, const std::stop_token& stop);

struct PoseFit {
  SE3 camera_from_board;
  double cost = 0;        // px^2
  double other_cost = 0;  // px^2, of the mirrored tilt
};

// The better of the two minima; bare parameters as in Model. Absent where the view determines no
// pose.
template <typename M>
[[nodiscard]] std::optional<PoseFit> fit_pose(const PointSet& view, const double* parameters,
                                              double skew, Loss loss);

}  // namespace calvin
