// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Clocks as unknowns of the least squares: those of cameras before which boards were moving.

#include "calvin/rig/joint/time_offsets.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calvin/rig/joint/extra_unknowns.hpp"

namespace calvin::rig {

namespace {

// How corners of one camera are seen elsewhere, by a second that its clock is behind: of views
// whose velocities are known.
Ways ways_of(std::size_t camera, const std::vector<BoardView>& views, const RigSolver& solver) {
  Ways ways(solver.places().views.size());
  for (std::size_t p = 0; p < ways.size(); ++p) {
    const BoardView& view = views[solver.places().views[p].view];
    if (view.of.camera != camera) continue;
    for (const Pixel& v : view.velocity) ways[p].push_back({-v.u, -v.v});
  }
  return ways;
}

}  // namespace

std::optional<TimeOffsets> time_offsets(std::size_t cameras, const std::vector<BoardView>& views,
                                        RigSolver& solver, double variance) {
  constexpr double kLeastPivot = 1;  // (px/s)^2: known to a tenth of a second or so
  constexpr double kStill = 1e-6;    // px/s
  const auto moves = [](const BoardView& view) { return !view.velocity.empty(); };
  if (std::ranges::none_of(views, moves)) return std::nullopt;
  std::vector<std::size_t> moving;
  std::vector<Ways> ways;
  for (std::size_t c = 1; c < cameras; ++c) {
    Ways of_camera = ways_of(c, views, solver);
    if (!(length_of(of_camera, solver) > kStill)) continue;
    moving.push_back(c);
    ways.push_back(std::move(of_camera));
  }
  const auto found = extra_unknowns(ways, solver, variance, kLeastPivot);
  if (!found) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(cameras);
  TimeOffsets offsets;
  offsets.seconds.assign(cameras, 0.0);
  offsets.sigma.assign(cameras, 0.0);
  offsets.covariance = Eigen::MatrixXd::Zero(count, count);
  offsets.places_by_offset = Eigen::MatrixXd::Zero(found->places_by_unknown.rows(), count);
  for (std::size_t k = 0; k < moving.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const auto camera = static_cast<Eigen::Index>(moving[k]);
    offsets.seconds[moving[k]] = found->step(at);
    offsets.sigma[moving[k]] = std::sqrt(found->covariance(at, at));
    offsets.places_by_offset.col(camera) = found->places_by_unknown.col(at);
    for (std::size_t l = 0; l < moving.size(); ++l) {
      offsets.covariance(camera, static_cast<Eigen::Index>(moving[l])) =
          found->covariance(at, static_cast<Eigen::Index>(l));
    }
  }
  return offsets;
}

}  // namespace calvin::rig
