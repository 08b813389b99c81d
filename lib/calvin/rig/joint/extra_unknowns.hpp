// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Unknowns that the least squares of a rig do not have, by what they do to the corners in the
// pictures: clocks that are apart, boards that are fixed to each other. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/joint/rig_solver.hpp"

namespace calvin::rig {

// How far each corner of each placed view is seen elsewhere by one unit of an unknown, px; empty
// for a view of which no corner is.
using Ways = std::vector<std::vector<Pixel>>;

struct ExtraUnknowns {
  Eigen::VectorXd step;        // to their optimum, in their units
  Eigen::MatrixXd covariance;  // in those of both
  // How the places of all cameras but the first move with them: d of each as retract() in
  // solve/residuals/bundle_problem.hpp has it, per unit, a column of each.
  Eigen::MatrixXd places_by_unknown;
};

// Root mean square of the ways of corners in use, px.
[[nodiscard]] double length_of(const Ways& ways, const RigSolver& solver);

// One step of Gauss-Newton from the optimum that `solver` has found, all places with it: the
// columns are what is left of the ways of corners when everything else has followed them.
// `variance` is that of the solver, px^2. Absent where the corners leave one of them open: less
// than `least_pivot` (px per unit)^2.
[[nodiscard]] std::optional<ExtraUnknowns> extra_unknowns(const std::vector<Ways>& ways,
                                                          RigSolver& solver, double variance,
                                                          double least_pivot);

}  // namespace calvin::rig
