// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The camera and the poses of a method, and how far they put the corners from where they are seen.

#include "calvin/solve/methods/method_solution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/solve/methods/methods.hpp"

namespace calvin {

namespace {

struct Residuals {
  double squares = 0;  // px^2
  int seen = 0;
  int unseen = 0;  // corners that the camera has no projection of
};

RayFromBoard as_rays(const SE3& camera_from_board) {
  RayFromBoard m;
  m << camera_from_board.rotation, camera_from_board.translation;
  return m;
}

Residuals residuals_of(const PointSet& view, const Camera& camera,
                       const RayFromBoard& ray_from_board) {
  Residuals sum;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    const auto at = camera.project(ray_from_board * view.points[i].homogeneous());
    if (!at) {
      ++sum.unseen;
      continue;
    }
    ++sum.seen;
    sum.squares += std::pow(at->u - view.uv[i].u, 2) + std::pow(at->v - view.uv[i].v, 2);
  }
  return sum;
}

// Copies the covariance, and sigmas out of it.
void add_sigmas(const MethodResult& found, Calibration& calibration) {
  for (std::size_t i = 0; i < found.estimated.size(); ++i) {
    const auto at = std::find_if(calibration.parameters.begin(), calibration.parameters.end(),
                                 [&](const Parameter& p) { return p.name == found.estimated[i]; });
    const auto k = static_cast<Eigen::Index>(i);
    at->sigma = std::sqrt(found.covariance(k, k));
  }
  const double* numbers = found.covariance.data();  // symmetric: rows are columns
  calibration.covariance.assign(numbers, numbers + found.covariance.size());
}

// Gives the corners that were left out no weight, and lists them.
void leave_out(const MethodResult& found, std::vector<PointSet>& views, Solution& solution) {
  for (const auto& [view, corner] : found.left_out) {
    views[view].weight[corner] = 0;
    solution.rejected_corners.push_back({views[view].index, views[view].ids[corner]});
  }
}

}  // namespace

Result<Solution> method_solution(std::vector<PointSet> views, ImageSize size,
                                 const SolveOptions& options) {
  const auto found = run_method(options.method, method_input(views, size, options));
  if (!found) return tl::unexpected<Error>(found.error());
  Solution solution;
  Calibration& calibration = solution.calibration;
  calibration = found->camera.to_calibration();
  calibration.remarks = found->remarks;
  add_sigmas(*found, calibration);
  leave_out(*found, views, solution);
  std::vector<Pixel> corners;
  Residuals all;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const SE3& pose = found->camera_from_board[v];
    const Residuals r =
        residuals_of(views[v], found->camera,
                     found->ray_from_board.empty() ? as_rays(pose) : found->ray_from_board[v]);
    all.squares += r.squares;
    all.seen += r.seen;
    all.unseen += r.unseen;
    ViewRecord record;
    record.timestamp = views[v].timestamp;
    record.points = r.seen + r.unseen;
    record.rms = r.seen > 0 ? std::sqrt(r.squares / r.seen) : 0;
    record.camera_from_board = to_pose(pose);
    calibration.views.push_back(record);
    for (std::size_t i = 0; i < views[v].size(); ++i) {
      if (views[v].weight[i] > 0) corners.push_back(views[v].uv[i]);
    }
  }
  if (all.seen > 0) calibration.rms = std::sqrt(all.squares / all.seen);
  if (all.unseen > 0) {
    calibration.remarks.push_back(
        fmt::format("{} corners have no projection before this camera.", all.unseen));
  }
  calibration.covered = convex_hull(std::move(corners));
  return solution;
}

}  // namespace calvin
