// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Simulated rigs as plain data.

#include "rig_views.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "simulated_rig.hpp"

namespace calvin::rig_views {

namespace {

std::vector<SeenByCamera> seen(const scenes::SimulatedRig& rig) {
  scenes::Random random(3);
  std::vector<SeenByCamera> all;
  const auto views = scenes::seen_by(rig, 40, 0.7, random);
  for (std::size_t c = 0; c < views.size(); ++c) {
    SeenByCamera& camera = all.emplace_back();
    camera.calibration = views[c].calibration;
    camera.world_from_camera = rig.world_from_camera[c];
    for (const View& view : views[c].views) camera.observations.push_back(view.observation);
  }
  return all;
}

}  // namespace

std::vector<SeenByCamera> stereo() {
  scenes::Random random(1);
  return seen(scenes::stereo_rig(random));
}

std::vector<SeenByCamera> ring() {
  scenes::Random random(2);
  return seen(scenes::ring_rig(4, random));
}

double worst_error(const Rig& rig, const std::vector<SeenByCamera>& truth) {
  double most = 0;
  for (std::size_t c = 1; c < truth.size(); ++c) {
    const SE3 pose = truth[0].world_from_camera.inverse() * truth[c].world_from_camera;
    most = std::max(most, scenes::place_error(rig.cameras[c], pose).largest);
  }
  return most;
}

}  // namespace calvin::rig_views
