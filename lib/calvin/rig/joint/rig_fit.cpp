// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The optimum, how well it is known, and what was left out of it.

#include "calvin/rig/joint/rig_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/rig/joint/rig_solver.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

namespace {

// px, not weighted, of the corners in use.
void add_rms(const std::vector<BoardView>& views, const RigSolver& solver,
             const std::vector<Camera>& cameras, RigFit& fit) {
  std::vector<double> squares(cameras.size(), 0.0);
  std::vector<double> corners(cameras.size(), 0.0);
  const RigSolver::Squares all = solver.squares();
  for (std::size_t p = 0; p < all.size(); ++p) {
    const BoardView& view = views[solver.places().views[p].view];
    for (std::size_t i = 0; i < all[p].size(); ++i) {
      if (!(solver.weights()[p][i] > 0)) continue;
      squares[view.of.camera] += all[p][i] / (view.seen.weight[i] * view.seen.weight[i]);
      corners[view.of.camera] += 1;
    }
  }
  double square = 0;
  double corner = 0;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    fit.camera_rms.push_back(corners[c] > 0 ? std::sqrt(squares[c] / corners[c]) : 0);
    square += squares[c];
    corner += corners[c];
  }
  fit.rms = corner > 0 ? std::sqrt(square / corner) : 0;
}

// Of the places of all cameras but the first. The equations over intrinsics as well are made where
// something is known of how well these are known.
std::optional<PlaceCovariance> place_covariance(RigSolver& solver,
                                                const std::vector<RigCameraViews>& calibrations,
                                                const ParameterTable& table, double variance) {
  const std::size_t cameras = table.cameras();
  const bool are_exact = table.intrinsics(0).empty();
  const auto equations = are_exact ? solver.equations() : solver.equations_over(table);
  if (!equations) return std::nullopt;
  const ParameterRange places = {table.rig_pose(1).first, kPose * static_cast<int>(cameras - 1)};
  return covariance_of_places(equations->information, places, variance,
                              covariance_of_intrinsics(table, calibrations));
}

bool are_exact(const std::vector<RigCameraViews>& calibrations) {
  return std::ranges::all_of(calibrations, [](const RigCameraViews& camera) {
    return camera.calibration.covariance.empty();
  });
}

}  // namespace

Result<RigFit> fit_rig(const std::vector<BoardView>& views, RigPlaces from,
                       const std::vector<RigCameraViews>& calibrations,
                       const std::vector<Camera>& cameras, const RigFitWishes& wishes,
                       const std::stop_token& stop) {
  RigSolver solver(views, std::move(from), cameras, stop);
  if (const Status solved = solver.run(); !solved) return tl::unexpected<Error>(solved.error());
  RigFit fit;
  const double variance = solver.variance();
  const bool only_places = wishes.free == nullptr && are_exact(calibrations);
  const ParameterTable table = only_places ? table_of_places(cameras) : table_of(cameras);
  std::optional<PlaceCovariance> known;
  if (wishes.free == nullptr) {
    known = place_covariance(solver, calibrations, table, variance);
  } else if (const auto equations = solver.equations_over(table)) {
    fit.intrinsics = intrinsics_step(*equations, *wishes.free, variance);
    known = fit.intrinsics->known;
  }
  if (!known) return undetermined_places();
  fit.covariance = known->of_places;
  if (wishes.world != nullptr && wishes.world->camera.empty()) {
    const auto pose = pose_at(*wishes.world, views, calibrations, solver);
    if (pose) fit.board = board_frame(*pose, solver, table, *known, variance);
    if (!fit.board) return undetermined_places();
  }
  fit.places = solver.places();
  for (std::size_t p = 0; p < fit.places.views.size(); ++p) {
    if (!solver.is_used(p)) fit.rejected.push_back(fit.places.views[p].view);
  }
  add_rms(views, solver, cameras, fit);
  fit.time_offsets = time_offsets(cameras.size(), views, solver, variance);
  fit.board_offsets = board_offsets(views, cameras, solver, variance);
  return fit;
}

}  // namespace calvin::rig
