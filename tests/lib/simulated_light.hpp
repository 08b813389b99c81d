// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras around a room through which a light is carried: what they see of it is missing here and
// there, and a reflection elsewhere.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/rig/solve_light.hpp"
#include "scenes.hpp"
#include "simulated_rig.hpp"

namespace calvin::scenes {

struct LitRoom {
  std::vector<Camera> cameras;
  std::vector<SE3> room_from_camera;
  Eigen::Vector3d half = {1.5, 1.5, 1.0};  // m, the room's half lengths: z points down
  double noise = 0.2;                      // px
  double missing = 0.2;                    // share of sightings
  double reflections = 0.1;                // share of what is left, anywhere in the picture
};

// Lenses of two radial coefficients, each camera of its own focal length and picture, along the
// walls at different heights. Axes are off the middle of the pictures by `off_center` of the width,
// 1 sigma.
inline LitRoom lit_room(int count, Random& random, double off_center = 0.03) {
  LitRoom room;
  for (int i = 0; i < count; ++i) {
    const ImageSize size = i % 2 == 0 ? ImageSize{1280, 960} : ImageSize{752, 480};
    const double f = size.width * uniform(random, 0.7, 1.1);
    std::normal_distribution<double> off(0, off_center * size.width);
    room.cameras.push_back(
        Camera::make("brown4", size,
                     {f, f, size.width / 2.0 + off(random), size.height / 2.0 + off(random),
                      uniform(random, -0.25, 0.05), uniform(random, -0.02, 0.08), 0, 0})
            .value());
    const double angle = 2 * std::numbers::pi * (i + uniform(random, -0.2, 0.2)) / count;
    const Eigen::Vector3d from(3.2 * std::cos(angle), 3.2 * std::sin(angle),
                               uniform(random, -1.5, 0.5));
    const Eigen::Vector3d at(uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3),
                             uniform(random, -0.2, 0.2));
    SE3 pose = looking(from, at);
    pose.rotation = pose.rotation * exp_so3({0, 0, uniform(random, -1.5, 1.5)});
    room.room_from_camera.push_back(pose);
  }
  return room;
}

inline std::optional<LightPoint> sighting(const LitRoom& room, std::size_t camera,
                                          const Eigen::Vector3d& light, Random& random) {
  std::normal_distribution<double> noise(0, room.noise);
  const ImageSize size = room.cameras[camera].image_size();
  if (uniform(random, 0, 1) < room.missing) return std::nullopt;
  if (uniform(random, 0, 1) < room.reflections) {
    return LightPoint{{uniform(random, 0, size.width - 1), uniform(random, 0, size.height - 1)},
                      room.noise};
  }
  const auto at = room.cameras[camera].project(room.room_from_camera[camera].inverse() * light);
  if (!at || at->u < 0 || at->v < 0 || at->u > size.width - 1 || at->v > size.height - 1) {
    return std::nullopt;
  }
  return LightPoint{{at->u + noise(random), at->v + noise(random)}, room.noise};
}

inline std::vector<Eigen::Vector3d> lights_in(const LitRoom& room, int instants, Random& random) {
  std::vector<Eigen::Vector3d> lights;
  for (int i = 0; i < instants; ++i) {
    lights.push_back(room.half.cwiseProduct(
        Eigen::Vector3d(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1))));
  }
  return lights;
}

// A wand of lights at these places along it, m, held up anywhere and in any direction: its lights
// one after the other, for each instant.
inline std::vector<Eigen::Vector3d> wands_in(const LitRoom& room, const std::vector<double>& places,
                                             int instants, Random& random) {
  std::vector<Eigen::Vector3d> lights;
  std::normal_distribution<double> any;
  for (const Eigen::Vector3d& middle : lights_in(room, instants, random)) {
    const Eigen::Vector3d along =
        Eigen::Vector3d(any(random), any(random), any(random)).normalized();
    for (const double place : places) {
      lights.push_back(middle + (place - places.back() / 2) * along);
    }
  }
  return lights;
}

// What all cameras see of lights at these places; intrinsics are not known.
inline std::vector<LightCamera> see_lights(const LitRoom& room,
                                           const std::vector<Eigen::Vector3d>& lights,
                                           Random& random) {
  std::vector<LightCamera> all(room.cameras.size());
  for (std::size_t c = 0; c < all.size(); ++c) {
    all[c].name = "cam" + std::to_string(c);
    all[c].image_size = room.cameras[c].image_size();
  }
  for (const Eigen::Vector3d& light : lights) {
    for (std::size_t c = 0; c < all.size(); ++c) {
      all[c].seen.push_back(sighting(room, c, light, random));
    }
  }
  return all;
}

// Where the first cameras stand, as a survey of the room would say it.
inline std::vector<CameraPlace> places_of(const LitRoom& room, std::size_t count) {
  std::vector<CameraPlace> places;
  for (std::size_t c = 0; c < count; ++c) {
    const Eigen::Vector3d& at = room.room_from_camera[c].translation;
    places.push_back({"cam" + std::to_string(c), {at.x(), at.y(), at.z()}});
  }
  return places;
}

// A light that is carried about, m, room: about a metre in a second.
inline Eigen::Vector3d carried_light(const LitRoom& room, double seconds) {
  return room.half.cwiseProduct(
      Eigen::Vector3d(0.6 * std::sin(0.7 * seconds) + 0.35 * std::sin(1.3 * seconds + 1),
                      0.6 * std::sin(0.53 * seconds + 2) + 0.35 * std::sin(1.1 * seconds),
                      0.6 * std::sin(0.61 * seconds + 4) + 0.35 * std::sin(1.7 * seconds + 3)));
}

}  // namespace calvin::scenes
