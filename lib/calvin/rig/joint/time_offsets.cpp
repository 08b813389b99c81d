// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Least squares with all other unknowns eliminated, by differences of its optimum.

#include "calvin/rig/joint/time_offsets.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calvin/geometry/dense.hpp"

namespace calvin::rig {

namespace {

constexpr Eigen::Index kPose = 6;

using Ways = std::vector<std::vector<Pixel>>;  // px/s or px, of placed views and their corners

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

// Root mean square of the corners in use that are on their way, px/s.
double speed_of(const Ways& ways, const RigSolver& solver) {
  double square = 0;
  double count = 0;
  for (std::size_t p = 0; p < ways.size(); ++p) {
    for (std::size_t i = 0; i < ways[p].size(); ++i) {
      if (!(solver.weights()[p][i] > 0)) continue;
      square += ways[p][i].u * ways[p][i].u + ways[p][i].v * ways[p][i].v;
      count += 1;
    }
  }
  return count > 0 ? std::sqrt(square / count) : 0;
}

// The step from one set of places to another, of all cameras but the first.
Eigen::VectorXd step_between(const std::vector<SE3>& from, const std::vector<SE3>& to) {
  Eigen::VectorXd step(kPose * static_cast<Eigen::Index>(from.size() - 1));
  for (std::size_t c = 1; c < from.size(); ++c) {
    const Eigen::Matrix3d turn = to[c].rotation * from[c].rotation.transpose();
    const auto at = kPose * static_cast<Eigen::Index>(c - 1);
    step.segment<3>(at) = log_so3(turn);
    step.segment<3>(at + 3) = to[c].translation - turn * from[c].translation;
  }
  return step;
}

struct Columns {
  std::vector<std::size_t> cameras;
  Eigen::MatrixXd residuals;  // px per s, a column of each
  Eigen::MatrixXd places;
};

std::optional<Columns> columns_of(std::size_t cameras, const std::vector<BoardView>& views,
                                  RigSolver& solver, const RigSolver::Optimum& start) {
  constexpr double kStep = 0.1;    // px, of the corners that move
  constexpr double kStill = 1e-6;  // px/s
  Columns columns;
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> found;
  for (std::size_t c = 1; c < cameras; ++c) {
    Ways ways = ways_of(c, views, solver);
    const double speed = speed_of(ways, solver);
    if (!(speed > kStill)) continue;
    const double step = kStep / speed;
    for (auto& view : ways) {
      for (Pixel& way : view) way = {step * way.u, step * way.v};
    }
    const auto moved = solver.refit(ways);
    if (!moved || moved->residuals.size() != start.residuals.size()) return std::nullopt;
    columns.cameras.push_back(c);
    found.emplace_back((moved->residuals - start.residuals) / step,
                       step_between(start.camera_from_rig, moved->camera_from_rig) / step);
  }
  if (found.empty()) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(found.size());
  columns.residuals.resize(start.residuals.size(), count);
  columns.places.resize(found.front().second.size(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    columns.residuals.col(k) = found[static_cast<std::size_t>(k)].first;
    columns.places.col(k) = found[static_cast<std::size_t>(k)].second;
  }
  return columns;
}

}  // namespace

std::optional<TimeOffsets> time_offsets(std::size_t cameras, const std::vector<BoardView>& views,
                                        RigSolver& solver, double variance) {
  constexpr double kLeastPivot = 1;  // (px/s)^2: known to a tenth of a second or so
  const auto moves = [](const BoardView& view) { return !view.velocity.empty(); };
  if (std::ranges::none_of(views, moves)) return std::nullopt;
  const auto start = solver.refit({});
  if (!start) return std::nullopt;
  const auto columns = columns_of(cameras, views, solver, *start);
  if (!columns) return std::nullopt;
  const Eigen::MatrixXd normal = columns->residuals.transpose() * columns->residuals;
  const auto count = static_cast<Eigen::Index>(cameras);
  const auto inverse =
      solve_definite(normal, Eigen::MatrixXd::Identity(normal.rows(), normal.cols()), kLeastPivot);
  if (!inverse) return std::nullopt;
  const Eigen::VectorXd best = -(*inverse * (columns->residuals.transpose() * start->residuals));
  TimeOffsets offsets;
  offsets.seconds.assign(cameras, 0.0);
  offsets.sigma.assign(cameras, 0.0);
  offsets.covariance = Eigen::MatrixXd::Zero(count, count);
  offsets.places_by_offset = Eigen::MatrixXd::Zero(columns->places.rows(), count);
  for (std::size_t k = 0; k < columns->cameras.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const auto camera = static_cast<Eigen::Index>(columns->cameras[k]);
    offsets.seconds[columns->cameras[k]] = best(at);
    offsets.sigma[columns->cameras[k]] = std::sqrt(variance * (*inverse)(at, at));
    offsets.places_by_offset.col(camera) = columns->places.col(at);
    for (std::size_t l = 0; l < columns->cameras.size(); ++l) {
      offsets.covariance(camera, static_cast<Eigen::Index>(columns->cameras[l])) =
          variance * (*inverse)(at, static_cast<Eigen::Index>(l));
    }
  }
  return offsets;
}

}  // namespace calvin::rig
