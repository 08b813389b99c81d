// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Intrinsics of a rig's cameras that are unknown: in which directions they move, and what was known
// of them before. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/rig/rig_views.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

// Over the intrinsics of all cameras, in the order of table_of().
struct FreeIntrinsics {
  std::vector<bool> is_free;  // per camera; the others are held
  // x = known + directions z: a column for each free direction. Where it is known how well they are
  // known, a column is one sigma long, and what errors cannot have (an aspect that was held) is in
  // none of them.
  Eigen::VectorXd known;
  Eigen::MatrixXd directions;
  double prior = 0;      // information of each z about 0
  Eigen::VectorXd z;     // where they are
  Eigen::MatrixXd held;  // covariance of those that are held
  // Variances over those that the noise of corners makes: the same boards, lenses and detector have
  // given the share of errors that the calibrations call systematic.
  double growth = 1;
};

// Of the cameras that may be free: those of which it is known how well they are known, or, where
// `has_prior` is false, all. Without a prior, parameters that have no sigma beside others that have
// one stay as they are.
[[nodiscard]] FreeIntrinsics free_intrinsics(const std::vector<RigCameraViews>& calibrations,
                                             const std::vector<Camera>& cameras,
                                             std::vector<bool> may_be_free, bool has_prior);

// From the optimum of the places for intrinsics as `free` has them to that of all.
struct IntrinsicsStep {
  Eigen::VectorXd step;  // of z
  Eigen::MatrixXd of_z;  // covariance
  // Of the places of all cameras but the first, as RigFit has it, and of the intrinsics.
  PlaceCovariance known;
};

// One step of Gauss-Newton. `equations`: over the intrinsics and the places of all cameras, for
// residuals of 1 px; `variance`: of the residuals, px^2.
[[nodiscard]] IntrinsicsStep intrinsics_step(const BundleProblem::Reduced& equations,
                                             const FreeIntrinsics& free, double variance);

}  // namespace calvin::rig
