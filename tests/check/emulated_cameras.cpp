// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the board is at a time, when each camera looks, and what it sees then.

#include "emulated_cameras.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "simulated_light.hpp"
#include "simulated_rig.hpp"

namespace calvin::emulated {

namespace {

constexpr std::size_t kCameras = 4;
constexpr double kNoise = 5;  // grey levels, as of a camera indoors

// world_from_board: carried about as by a hand, in view of all cameras.
SE3 board_at(double t) {
  const Eigen::Matrix3d turn =
      exp_so3({0.35 * std::sin(1.1 * t), 0.35 * std::sin(0.9 * t + 1), 0.25 * std::sin(0.7 * t)});
  const Eigen::Vector3d middle(0.08 * std::sin(0.8 * t + 2), 0.05 * std::sin(1.3 * t),
                               0.08 * std::sin(0.6 * t + 1));
  const BoardArea extent = scenes::kBoard.extent();
  return {turn, middle - turn * Eigen::Vector3d(extent.width() / 2, extent.height() / 2, 0)};
}

SE3 light_at(double t) {
  return {Eigen::Matrix3d::Identity(), scenes::carried_light(scenes::LitRoom(), t)};
}

// A lens as solve_light() takes it to be.
Camera light_camera(ImageSize size, scenes::Random& random) {
  constexpr double kOff = 0.02;  // of the width
  const auto off = [&] { return scenes::uniform(random, -kOff, kOff) * size.width; };
  const double f = scenes::uniform(random, 0.7, 1.0) * size.width;
  return Camera::make("brown4", size,
                      {f, f, size.width / 2.0 + off(), size.height / 2.0 + off(),
                       scenes::uniform(random, -0.2, 0), scenes::uniform(random, 0, 0.05), 0, 0})
      .value();
}

// Around the room.
std::vector<SE3> places_around() {
  scenes::Random random(5);
  return scenes::lit_room(kCameras, random).room_from_camera;
}

// Before the board, which faces them.
std::vector<SE3> places_before() {
  std::vector<SE3> all;
  const Eigen::Vector3d from[kCameras] = {
      {-0.25, -0.05, -0.6}, {-0.08, 0.12, -0.62}, {0.1, -0.12, -0.58}, {0.27, 0.04, -0.6}};
  for (const Eigen::Vector3d& place : from) {
    const Eigen::Vector3d forward = -place.normalized();
    const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(forward).normalized();
    Eigen::Matrix3d rotation;
    rotation << right, forward.cross(right), forward;
    all.push_back({rotation, place});
  }
  return all;
}

std::uint64_t to_ns(double seconds) {
  return static_cast<std::uint64_t>(std::llround(1e9 * seconds));
}

}  // namespace

Cameras render(const Settings& settings) {
  scenes::Random random(17);
  Cameras all;
  all.before = all.after = settings.has_light ? places_around() : places_before();
  const Board board = settings.has_light ? Board(PointLight()) : Board(scenes::kBoard);
  if (settings.bumped) {
    SE3& place = all.after[*settings.bumped];
    place.rotation = exp_so3(settings.bump_turn * Eigen::Vector3d(0.6, 0.8, 0)) * place.rotation;
    place.translation += settings.bump_place * Eigen::Vector3d(0.48, 0.6, -0.64);
  }
  constexpr double kPhases[kCameras] = {1e-3, 4e-3, 7e-3, 2.5e-3};  // s
  for (std::size_t c = 0; c < kCameras; ++c) {
    const Camera camera = settings.has_light
                              ? light_camera(settings.size, random)
                              : scenes::random_camera("brown5", random, settings.size);
    const BoardRenderer renderer(camera);
    all.calibrations.push_back(camera.to_calibration());
    all.calibrations.back().camera = "cam" + std::to_string(c);
    const double drift = settings.drift * static_cast<double>(c) / (kCameras - 1);
    const int count = static_cast<int>(settings.seconds * settings.rate);
    for (int n = 0; n < count; ++n) {
      const double jitter = scenes::uniform(random, -settings.jitter, settings.jitter);
      const bool is_lost = scenes::uniform(random, 0, 1) < settings.lost;
      const double phase = settings.is_synchronous ? 0 : kPhases[c];
      const double t = phase + std::max(0.0, n * (1 + drift) / settings.rate + jitter);
      if (is_lost) continue;
      if (settings.stopped == c && t >= settings.stops && t < settings.starts) continue;
      const SE3& place = t < settings.bump ? all.before[c] : all.after[c];
      RenderOptions options;
      options.noise = kNoise;
      options.blur = 0.7;
      options.seed = noise_seed(c, static_cast<std::uint64_t>(n));
      const SE3 carried = settings.has_light ? light_at(t) : board_at(t);
      all.frames.push_back(
          {c, to_ns(t), renderer.render(board, place.inverse() * carried, options)});
    }
  }
  std::ranges::stable_sort(all.frames, {}, &Frame::timestamp);
  return all;
}

Error error_of(const Rig& rig, const std::vector<SE3>& world_from_camera) {
  Error error;
  const bool is_placed = rig.world == kPlacesWorld;
  const std::size_t first = is_placed ? 0 : 1;
  for (std::size_t c = first; c < rig.cameras.size(); ++c) {
    SE3 truth = world_from_camera[c];
    if (!is_placed) truth = world_from_camera[0].inverse() * truth;
    const auto one = scenes::place_error(rig.cameras[c], truth);
    error.square += one.square / static_cast<double>(rig.cameras.size() - first);
    error.largest = std::max(error.largest, one.largest);
  }
  return error;
}

}  // namespace calvin::emulated
