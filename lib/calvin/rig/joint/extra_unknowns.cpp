// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Least squares with all other unknowns eliminated, by differences of its optimum.

#include "calvin/rig/joint/extra_unknowns.hpp"

#include <cmath>
#include <cstddef>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/pose_unknowns.hpp"

namespace calvin::rig {

namespace {

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
  Eigen::MatrixXd residuals;  // px per unit, a column of each unknown
  Eigen::MatrixXd places;
};

std::optional<Columns> columns_of(const std::vector<Ways>& all, RigSolver& solver,
                                  const RigSolver::Optimum& start) {
  constexpr double kStep = 0.1;  // px, of the corners that move
  const auto cameras = static_cast<Eigen::Index>(start.camera_from_rig.size());
  const auto count = static_cast<Eigen::Index>(all.size());
  Columns columns = {Eigen::MatrixXd(start.residuals.size(), count),
                     Eigen::MatrixXd(kPose * (cameras - 1), count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    Ways ways = all[static_cast<std::size_t>(k)];
    const double step = kStep / length_of(ways, solver);
    if (!std::isfinite(step)) return std::nullopt;
    for (auto& view : ways) {
      for (Pixel& way : view) way = {step * way.u, step * way.v};
    }
    const auto moved = solver.refit(ways);
    if (!moved || moved->residuals.size() != start.residuals.size()) return std::nullopt;
    columns.residuals.col(k) = (moved->residuals - start.residuals) / step;
    columns.places.col(k) = step_between(start.camera_from_rig, moved->camera_from_rig) / step;
  }
  return columns;
}

}  // namespace

double length_of(const Ways& ways, const RigSolver& solver) {
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

std::optional<ExtraUnknowns> extra_unknowns(const std::vector<Ways>& ways, RigSolver& solver,
                                            double variance, double least_pivot) {
  if (ways.empty()) return std::nullopt;
  const auto start = solver.refit({});
  if (!start) return std::nullopt;
  const auto columns = columns_of(ways, solver, *start);
  if (!columns) return std::nullopt;
  const Eigen::MatrixXd normal = transposed_product(columns->residuals, columns->residuals);
  const auto inverse =
      solve_definite(normal, Eigen::MatrixXd::Identity(normal.rows(), normal.cols()), least_pivot);
  if (!inverse) return std::nullopt;
  return ExtraUnknowns{-(*inverse * (columns->residuals.transpose() * start->residuals)),
                       variance * *inverse, columns->places};
}

}  // namespace calvin::rig
