// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views of a lens that zooms, with square pixels, solved by Ceres: all unknowns at once, where
// solve_zooming() goes from view to view.
#pragma once

#include <array>
#include <vector>

#include "ceres_hand_eye.hpp"
#include "zooming_scene.hpp"

namespace calvin::formulas {

// A corner before a brown4 of which f and k1 are the view's, and the principal point is of all.
struct SeenByZoom {
  Eigen::Vector3d point;
  Pixel seen;

  template <typename T>
  bool operator()(const T* center, const T* f_k1, const T* pose, T* out) const {
    const T on_board[3] = {T(point.x()), T(point.y()), T(point.z())};
    T p[3];
    apply(pose, on_board, p);
    const T lens[4] = {f_k1[1], T(0), T(0), T(0)};
    T xy[2];
    if (!Brown4::distort(lens, p, xy)) return false;
    out[0] = f_k1[0] * xy[0] + center[0] - seen.u;
    out[1] = f_k1[0] * xy[1] + center[1] - seen.v;
    return true;
  }
};

struct CeresZooming {
  std::array<double, 2> center{};
  std::vector<std::array<double, 2>> f_k1;
};

// From the truth to where the squares are least.
inline CeresZooming solve_zooming_by_ceres(const scenes::ZoomingScene& scene) {
  CeresZooming at;
  at.center = {scene.cameras[0].cx(), scene.cameras[0].cy()};
  at.f_k1.resize(scene.views.size());
  std::vector<PoseNumbers> poses(scene.views.size());
  ceres::Problem problem;
  ceres::Solver::Options options = settled(ceres::DENSE_SCHUR);
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    at.f_k1[v] = {scene.cameras[v].fx(), scene.cameras[v].parameters()[4]};
    poses[v] = to_numbers(scene.poses[v]);
    const auto points = scene.views[v].board.points();
    const Observation& seen = scene.views[v].observation;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<SeenByZoom, 2, 2, 2, 6>(
              new SeenByZoom{points[static_cast<std::size_t>(seen.ids[i])], seen.uv[i]}),
          nullptr, at.center.data(), at.f_k1[v].data(), poses[v].data());
    }
    options.linear_solver_ordering->AddElementToGroup(poses[v].data(), 0);
    options.linear_solver_ordering->AddElementToGroup(at.f_k1[v].data(), 1);
  }
  options.linear_solver_ordering->AddElementToGroup(at.center.data(), 1);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return at;
}

}  // namespace calvin::formulas
