// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras of known intrinsics as unknowns of a table: they are held, and how well they are known is
// a part of what is found. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/rig/rig_views.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"

namespace calvin::rig {

// The intrinsics of all cameras and the places of all but the first, and what is unknown of the one
// board.
[[nodiscard]] ParameterTable table_of(const std::vector<Camera>& cameras,
                                      const BoardUnknowns& board = {});

// The places of all cameras but the first, whose intrinsics are known.
[[nodiscard]] ParameterTable table_of_places(const std::vector<Camera>& cameras);

// The table with the intrinsics of all cameras held at their values.
[[nodiscard]] ParameterTable with_held_intrinsics(ParameterTable table,
                                                  const std::vector<double>& values);

// A value of every unknown of that table; the places are 0.
[[nodiscard]] std::vector<double> values_of_cameras(const ParameterTable& table,
                                                    const std::vector<Camera>& cameras);

// The covariance of the intrinsics of all cameras, over the unknowns of the table.
[[nodiscard]] Eigen::MatrixXd covariance_of_intrinsics(
    const ParameterTable& table, const std::vector<RigCameraViews>& calibrations);

// How well places are known, beside the intrinsics.
struct PlaceCovariance {
  Eigen::MatrixXd of_places;
  Eigen::MatrixXd with_intrinsics;  // of a place and an intrinsic parameter: a column for each
  Eigen::MatrixXd of_intrinsics;
};

// The covariance of unknowns that stand behind all intrinsics: by the noise of the corners, of
// `variance` px^2, and by that of the intrinsics, which move the optimum by -H_pp^-1 H_pi of their
// own error (the implicit function of the gradient). `information` is over all unknowns, for
// residuals of 1 px. Absent where it does not determine the unknowns.
[[nodiscard]] std::optional<PlaceCovariance> covariance_of_places(
    const Eigen::MatrixXd& information, const ParameterRange& places, double variance,
    const Eigen::MatrixXd& of_intrinsics);

}  // namespace calvin::rig
