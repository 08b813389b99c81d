// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-solve: what it says of every view, and of the lens.
#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/residuals/straightness.hpp"
#include "calvin/solve/solve.hpp"

#include "solve_views.hpp"

namespace solve_print {

inline constexpr double kMillimetre = 1e-3;  // m

// The distances of the points of a view from where the camera puts them on the board as it is bent,
// px.
struct Distances {
  double mean = 0;
  double farthest = 0;
  int id = 0;  // of the point that is farthest
};
inline Distances distances_of(const calvin::View& view, const std::set<int>& left_out,
                              const calvin::SE3& camera_from_board, const calvin::BoardWarp& warp,
                              const calvin::Camera& camera) {
  Distances all;
  double count = 0;
  const auto points = calvin::bent_points(view.board, warp);
  const calvin::Observation& seen = view.observation;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const auto index = view.board.index_of(seen.ids[i]);
    if (!index || left_out.contains(seen.ids[i])) continue;
    const auto at = camera.project(camera_from_board * points[*index]);
    if (!at) continue;
    const double distance = std::hypot(at->u - seen.uv[i].u, at->v - seen.uv[i].v);
    all.mean += distance;
    ++count;
    if (distance < all.farthest) continue;
    all.farthest = distance;
    all.id = seen.ids[i];
  }
  all.mean /= std::max(count, 1.0);
  return all;
}

// Lines for each view: how well it fits, and where the camera was.
inline void print_view(std::string_view name, const calvin::ViewRecord& record,
                       const Distances& d) {
  const calvin::SE3 camera_from_board = calvin::to_se3(record.camera_from_board);
  const Eigen::Vector3d t = camera_from_board.translation / kMillimetre;
  const Eigen::Vector3d place = camera_from_board.inverse().translation / kMillimetre;
  fmt::print("view {}: {} points, rms {:.4f} px, mean {:.4f}, farthest {:.4f} (point {})\n", name,
             record.points, record.rms, d.mean, d.farthest, d.id);
  fmt::print("  T {:.3f} {:.3f} {:.3f} mm, camera at {:.3f} {:.3f} {:.3f} mm\n", t.x(), t.y(),
             t.z(), place.x(), place.y(), place.z());
}

// `views` as they were solved, `names` by what they are called; `has_poses`: whether the focal
// length is known, without which there are none.
inline void print_views(const calvin::Solution& solution, const std::vector<calvin::View>& views,
                        const solve_views::NamedViews& names, bool has_poses) {
  std::vector<bool> rejected(views.size(), false);
  std::vector<std::set<int>> left_out(views.size());  // points of each view
  for (const calvin::RejectedCorner& corner : solution.rejected_corners) {
    left_out[corner.view].insert(corner.id);
  }
  for (const calvin::RejectedView& view : solution.rejected) {
    rejected[view.index] = true;
    fmt::print("view {}: left out ({})\n", names[view.index].name, calvin::to_string(view.reason));
  }
  const auto camera = calvin::Camera::make(solution.calibration);
  auto record = solution.calibration.views.begin();
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (rejected[i] || record == solution.calibration.views.end() || !camera) continue;
    if (has_poses) {
      const Distances d =
          distances_of(views[i], left_out[i], calvin::to_se3(record->camera_from_board),
                       solution.calibration.warp.value_or(calvin::BoardWarp()), *camera);
      print_view(names[i].name, *record, d);
    } else {
      fmt::print("view {}: {} points, rms {:.4f} px\n", names[i].name, record->points, record->rms);
    }
    ++record;
  }
}

// How straight rows and columns of the boards become.
inline void print_straightness(const std::vector<calvin::View>& views,
                               const calvin::Solution& solution) {
  const auto camera = calvin::Camera::make(solution.calibration);
  const auto straight =
      camera ? calvin::straightness(views, solution.rejected_corners, *camera) : std::nullopt;
  if (!straight) return;
  fmt::print(
      "straightness: {} rows and columns, rms {:.4f} px from straight lines, {:.4f} as seen\n",
      straight->lines, straight->mended, straight->seen);
}

inline void print_on_sensor(const calvin::Calibration& calibration, double pitch) {
  const auto* fx = calibration.find("fx");
  const auto* fy = calibration.find("fy");
  if (fx == nullptr || fy == nullptr) return;
  fmt::print("on the sensor: f {:.6g} mm along x, {:.6g} mm along y\n",
             fx->value * pitch / kMillimetre, fy->value * pitch / kMillimetre);
}

}  // namespace solve_print
