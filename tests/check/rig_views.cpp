// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Simulated rigs as plain data.

#include "rig_views.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <Eigen/Cholesky>

#include "simulated_box.hpp"
#include "simulated_light.hpp"
#include "simulated_rig.hpp"

namespace calvin::rig_views {

namespace {

std::vector<SeenByCamera> as_data(const std::vector<RigCameraViews>& views,
                                  const std::vector<SE3>& world_from_camera) {
  std::vector<SeenByCamera> all;
  for (std::size_t c = 0; c < views.size(); ++c) {
    SeenByCamera& camera = all.emplace_back();
    camera.calibration = views[c].calibration;
    camera.world_from_camera = world_from_camera[c];
    for (const View& view : views[c].views) camera.observations.push_back(view.observation);
  }
  return all;
}

std::vector<SeenByCamera> seen(const scenes::SimulatedRig& rig) {
  scenes::Random random(3);
  return as_data(scenes::seen_by(rig, 40, 0.7, random), rig.world_from_camera);
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

std::vector<SeenByCamera> swinging(int seconds, double behind) {
  constexpr int kRate = 30;
  constexpr double kSecond = 1e9;  // ns
  scenes::Random random(6);
  const scenes::SimulatedRig rig = scenes::stereo_rig(random);
  const scenes::Swing swing(random);
  std::vector<RigCameraViews> all(2);
  for (std::size_t c = 0; c < 2; ++c) {
    all[c].calibration = rig.cameras[c].to_calibration();
    for (int n = 0; n < kRate * seconds; ++n) {
      const double time = 1 + static_cast<double>(n) / kRate;
      const SE3 pose = rig.world_from_camera[c].inverse() * swing.at(time);
      if (!scenes::faces(pose) || !scenes::sees_all(rig.cameras[c], rig.board, pose)) continue;
      View view = scenes::observe(rig.cameras[c], rig.board, pose, rig.noise, random);
      const double late = c == 0 ? 0 : behind;
      view.observation.timestamp =
          static_cast<std::uint64_t>(std::llround(kSecond * (time - late)));
      all[c].views.push_back(std::move(view));
    }
  }
  return as_data(all, rig.world_from_camera);
}

std::vector<SeenByCamera> before_a_box() {
  scenes::Random random(5);
  const scenes::BoxStudio studio = scenes::box_studio(scenes::kSides, 2, random);
  return as_data(scenes::boxes_seen_in(studio, 60, random), studio.world_from_camera);
}

namespace {

std::vector<SeenByCamera> lit_room(int instants, const std::vector<double>& wand,
                                   const char* board) {
  constexpr std::uint64_t kFrame = 33'333'333;  // ns
  scenes::Random random(4);
  const scenes::LitRoom room = scenes::lit_room(4, random);
  const std::size_t lights = wand.size();
  const auto places = lights > 1 ? scenes::wands_in(room, wand, instants, random)
                                 : scenes::lights_in(room, instants, random);
  const auto seen = scenes::see_lights(room, places, random);
  std::vector<SeenByCamera> all;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    SeenByCamera& camera = all.emplace_back();
    camera.calibration = room.cameras[c].to_calibration();
    camera.calibration.camera = seen[c].name;
    camera.world_from_camera = room.room_from_camera[c];
    for (std::size_t i = 0; i < seen[c].seen.size() / lights; ++i) {
      Observation one;
      one.board = board;
      // The light is elsewhere in every picture: too far apart in time to tell how it moves.
      one.timestamp = 10 * kFrame * (i + 1);
      one.image_size = seen[c].image_size;
      for (std::size_t k = 0; k < lights; ++k) {
        const auto& light = seen[c].seen[lights * i + k];
        if (!light) continue;
        one.ids.push_back(static_cast<int>(k));
        one.uv.push_back(light->uv);
        one.sigma.push_back(light->sigma);
      }
      if (one.found()) camera.observations.push_back(std::move(one));
    }
  }
  return all;
}

}  // namespace

std::vector<SeenByCamera> lit_room(int instants) { return lit_room(instants, {0}, "dot"); }

std::vector<SeenByCamera> lit_room_of_wand(int instants) {
  return lit_room(instants, {0, 0.15, 0.5}, "wand:150mm+350mm");
}

double worst_error(const Rig& rig, const std::vector<SeenByCamera>& truth) {
  double most = 0;
  const bool is_placed = rig.world == kPlacesWorld;
  for (std::size_t c = is_placed ? 0 : 1; c < truth.size(); ++c) {
    SE3 pose = truth[c].world_from_camera;
    if (!is_placed) pose = truth[0].world_from_camera.inverse() * pose;
    most = std::max(most, scenes::place_error(rig.cameras[c], pose).largest);
  }
  return most;
}

}  // namespace calvin::rig_views
