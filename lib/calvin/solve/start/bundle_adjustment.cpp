// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One minimisation over some views, the distances of corners after it, and poses for a camera.

#include "calvin/solve/start/bundle_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/start/pose_fit.hpp"

namespace calvin {

BundleAdjustment::BundleAdjustment(const Parameterization& parameterization, ImageSize size,
                                   const std::stop_token& stop)
    : parameterization_(parameterization),
      size_(size),
      stop_(stop),
      fill_(fill_rows_of(parameterization.model)),
      rows_(row_layout(parameterization.table, 0, 0)) {}

RowSums BundleAdjustment::fill_residuals(const FitView& view, const std::vector<double>& shared,
                                         const SE3& pose) {
  rows_.resize(view.points.padded());
  return fill_(view.points, row_point(parameterization_.table, 0, 0, shared), pose, Loss{}, rows_,
               RowContent::kResiduals);
}

Minimum BundleAdjustment::minimise_over(const std::vector<const FitView*>& views, Estimate from,
                                        const Eigen::MatrixXd& basis, const Loss& loss,
                                        const LmOptions& options,
                                        const std::vector<ParameterTable::Prior>& more) {
  SharedUnknowns unknowns = {&parameterization_.table, basis, parameterization_.table.priors()};
  unknowns.priors.insert(unknowns.priors.end(), more.begin(), more.end());
  Minimum result = {std::move(from), {}};
  Estimate& at = result.at;
  std::vector<std::size_t> index;  // the view of each pose of the problem
  const auto make_problem = [&]() -> std::optional<BundleProblem> {
    ResidualBlocks blocks;
    BundlePoint start = {at.shared, {}, {}, {}};
    index.clear();
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (views[v] == nullptr || !at.poses[v]) continue;
      blocks.boards.push_back({&views[v]->points, index.size()});
      index.push_back(v);
      start.rig_from_board.push_back(*at.poses[v]);
    }
    if (index.empty()) return std::nullopt;
    return BundleProblem(std::move(blocks), unknowns, std::move(start), loss, stop_);
  };
  auto problem = make_problem();
  if (cancelled()) return result;
  if (problem && !problem->valid()) {
    for (const std::size_t v : index) {
      if (!fill_residuals(*views[v], at.shared, *at.poses[v]).valid) at.poses[v].reset();
    }
    problem = make_problem();
  }
  if (!problem || !problem->valid()) return result;
  const LmReport report = minimise(*problem, options, stop_);
  iterations_ += report.iterations;
  cancelled_ = cancelled_ || report.cancelled;
  result.converged = report.converged;
  at.shared = problem->point().shared;
  for (std::size_t i = 0; i < index.size(); ++i) {
    at.poses[index[i]] = problem->point().rig_from_board[i];
  }
  result.problem = std::move(problem);
  return result;
}

std::vector<double> BundleAdjustment::distances(const FitView& view,
                                                const std::vector<double>& shared,
                                                const std::optional<SE3>& pose) {
  std::vector<double> result(view.set.size(), kFarthest);
  if (!pose) return result;
  const auto bounded = [](double d) {
    return std::isfinite(d) ? std::min(d, kFarthest) : kFarthest;
  };
  if (fill_residuals(view, shared, *pose).valid) {
    const double* u = rows_.u(RowLayout::kResidual);
    const double* v = rows_.v(RowLayout::kResidual);
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i] = bounded(std::sqrt(u[i] * u[i] + v[i] * v[i]));
    }
    return result;
  }
  // Some corner has no projection, so the rows are void: each corner is projected by itself.
  const auto seen_by = camera(shared);
  for (std::size_t i = 0; seen_by && i < result.size(); ++i) {
    const auto at = seen_by->project(*pose * view.set.points[i]);
    if (!at) continue;
    const Pixel seen = view.set.uv[i];
    result[i] = bounded(view.set.weight[i] * std::hypot(at->u - seen.u, at->v - seen.v));
  }
  return result;
}

std::optional<Camera> BundleAdjustment::camera(const std::vector<double>& shared) const {
  const ParameterTable& table = parameterization_.table;
  const auto own = values_of(shared, table.intrinsics(0));
  auto made = Camera::make(parameterization_.model, size_, {own.begin(), own.end()},
                           table.skew_at(0, shared));
  if (!made) return std::nullopt;
  return *made;
}

Poses BundleAdjustment::poses_for(const std::vector<double>& shared,
                                  const std::vector<const FitView*>& views) const {
  Poses poses(views.size());
  const auto seen_by = camera(shared);
  if (!seen_by) return poses;
  const CameraPoints points(*seen_by);
  for (std::size_t v = 0; v < views.size() && !stop_.stop_requested(); ++v) {
    poses[v] = start_pose(views[v]->set, rays_of(views[v]->set, points));
  }
  return poses;
}

}  // namespace calvin
