// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Measures each view once, then compares every two of an instant.

#include "calvin/rig/watch/pair_tests.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "calvin/rig/clocks/timing.hpp"

namespace calvin::rig {

namespace {

Result<std::vector<Camera>> cameras_of(const std::vector<RigCameraViews>& seen) {
  std::vector<Camera> cameras;
  for (const RigCameraViews& one : seen) {
    auto camera = Camera::make(one.calibration);
    if (!camera) return tl::unexpected<Error>(camera.error());
    cameras.push_back(*std::move(camera));
  }
  return cameras;
}

// Of each camera of the rig, s.
std::vector<double> offsets_of(const Rig& rig) {
  std::vector<double> offsets;
  for (const RigCamera& camera : rig.cameras) {
    offsets.push_back(camera.time_offset ? camera.time_offset->seconds : 0);
  }
  return offsets;
}

}  // namespace

Result<std::vector<PairTest>> test_pairs(const Rig& rig, const std::vector<RigCameraViews>& seen,
                                         std::uint64_t tolerance) {
  const std::vector<RigCameraViews> ordered = views_of_rig(rig, seen);
  const auto cameras = cameras_of(ordered);
  if (!cameras) return tl::unexpected<Error>(cameras.error());
  auto views = board_views(ordered, *cameras);
  if (!views) return tl::unexpected<Error>(views.error());
  const std::vector<ViewTimes> times = view_times(ordered, offsets_of(rig));
  const Instants instants = pair_instants(times, tolerance);
  auto groups = group_views(instants, *views);
  allow_for_timing(times, *views, groups);
  std::vector<std::optional<MeasuredPose>> measured(views->size());
  const auto pose_of = [&](std::size_t v) -> const MeasuredPose& {
    const std::size_t camera = (*views)[v].of.camera;
    auto& pose = measured[v];
    if (!pose) pose = measure_pose((*views)[v], ordered[camera].calibration, (*cameras)[camera]);
    return *pose;
  };
  std::vector<PairTest> tests;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const std::size_t v : groups[g]) {
      for (const std::size_t w : groups[g]) {
        const BoardView& own = (*views)[v];
        const BoardView& other = (*views)[w];
        if (own.board != other.board || own.of.camera == other.of.camera) continue;
        const auto found = discrepancy(rig.cameras[other.of.camera], pose_of(w),
                                       rig.cameras[own.of.camera], pose_of(v));
        if (!found) continue;
        tests.push_back({own.of.camera,
                         other.of.camera,
                         instants.instants[g].timestamp,
                         {own.seen.uv.front(), own.seen.uv.back()},
                         *found});
      }
    }
  }
  return tests;
}

}  // namespace calvin::rig
