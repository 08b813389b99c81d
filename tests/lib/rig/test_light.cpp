// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras around a room in which a light is moved, of which all is known: they are found in spite
// of gaps and reflections, and their errors are what is said of them. What cannot be solved is
// refused.
#include <chrono>
#include <cmath>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "calvin/rig/solve_light.hpp"
#include "light_errors.hpp"
#include "simulated_light.hpp"

namespace calvin {
namespace {

using scenes::errors_of;
using scenes::LitRoom;
using scenes::Normalised;
using scenes::normalised;
using scenes::places_of;
using scenes::Random;

struct Case {
  int cameras;
  double off_center;  // 1 sigma of the axes, of the width, which the options tell
  double noise;       // px
  int trials;         // reduced
  int full_trials;
};
// Three cameras tell little of their axes, and what is known of these decides on the focal lengths.
const Case kCases[] = {{3, 0.01, 0.1, 24, 300}, {5, 0.03, 0.2, 10, 200}, {16, 0.03, 0.2, 2, 20}};

class Light : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Cameras, Light, ::testing::ValuesIn(kCases),
                         [](const auto& test) { return std::to_string(test.param.cameras); });

TEST_P(Light, IsAsWellKnownAsItSays) {
  const Case& kind = GetParam();
  const int trials = scenes::full_count() ? kind.full_trials : kind.trials;
  Normalised all;
  double reflections = 0;
  double refused = 0;
  double seconds = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(100 + static_cast<std::uint64_t>(trial));
    LitRoom room = scenes::lit_room(kind.cameras, random, kind.off_center);
    room.noise = kind.noise;
    const auto lights = scenes::lights_in(room, 1000, random);
    const auto seen = scenes::see_lights(room, lights, random);
    LightOptions options;
    options.places = places_of(room, room.cameras.size());
    options.center_sigma = kind.off_center;
    const auto start = std::chrono::steady_clock::now();
    const auto solved = solve_light(seen, options);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    const Normalised one = normalised(*solved, errors_of(*solved, room));
    EXPECT_LT(one.largest, 4.5) << trial;
    all.square += one.square;
    all.degrees += one.degrees;
    for (const LightCameraErrors& own : solved->errors) {
      reflections += room.reflections * static_cast<double>(own.seen);
      refused += static_cast<double>(own.seen - own.used);
    }
  }
  std::cout << kind.cameras << " cameras: e^T C^-1 e / " << all.degrees << " = "
            << all.square / all.degrees << ", " << seconds / trials << " s each, " << refused
            << " sightings refused\n";
  EXPECT_NEAR(all.square / all.degrees, 1, 0.2);
  EXPECT_GT(refused, 0.8 * reflections);
}

// Every reflection that is far from the true place is refused, and next to nothing else: a sighting
// that had a reflection alone beside it.
TEST(LightSightings, ThatAreReflectionsAreRefused) {
  Random random(7);
  const LitRoom room = scenes::lit_room(6, random);
  const auto lights = scenes::lights_in(room, 400, random);
  const auto seen = scenes::see_lights(room, lights, random);
  const auto solved = solve_light(seen);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  int good = 0;
  int lost = 0;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
      if (!seen[c].seen[i]) continue;
      const auto at = room.cameras[c].project(room.room_from_camera[c].inverse() * lights[i]);
      const Pixel& uv = seen[c].seen[i]->uv;
      const double off = at ? std::hypot(at->u - uv.u, at->v - uv.v) : 1e6;
      if (off > 20 * room.noise) {
        EXPECT_FALSE(solved->used[c][i]) << c << ' ' << i << ' ' << off;
      }
      if (off > 4 * room.noise) continue;
      ++good;
      lost += solved->used[c][i] ? 0 : 1;
    }
  }
  EXPECT_GT(good, 1000);
  EXPECT_LT(lost, good / 30);
}

// The same sightings, the same numbers.
TEST(LightSolve, IsRepeated) {
  Random random(8);
  const LitRoom room = scenes::lit_room(4, random);
  const auto seen = scenes::see_lights(room, scenes::lights_in(room, 150, random), random);
  const auto once = solve_light(seen);
  const auto again = solve_light(seen);
  ASSERT_TRUE(once.has_value()) << once.error().message;
  ASSERT_TRUE(again.has_value());
  EXPECT_FALSE(once->rig.is_metric) << "no place of a camera was known";
  for (std::size_t c = 0; c < seen.size(); ++c) {
    for (std::size_t p = 0; p < 4; ++p) {
      EXPECT_EQ(once->rig.cameras[c].calibration.parameters[p].value,
                again->rig.cameras[c].calibration.parameters[p].value);
    }
  }
}

// Cameras whose lenses are known, two of them or a wide one among many, are merely placed.
TEST(LightSolve, PlacesCamerasThatAreKnown) {
  for (const int count : {2, 4}) {
    Random random(9);
    LitRoom room = scenes::lit_room(count, random);
    auto seen = scenes::see_lights(room, scenes::lights_in(room, 300, random), random);
    for (std::size_t c = 0; c < seen.size(); ++c) {
      seen[c].calibration = room.cameras[c].to_calibration();
    }
    LightOptions options;
    options.places = places_of(room, 2);
    const auto solved = solve_light(seen, options);
    ASSERT_TRUE(solved.has_value()) << count << ": " << solved.error().message;
    EXPECT_TRUE(solved->rig.is_metric);
    EXPECT_EQ(solved->rig.world, "cam0");
    for (std::size_t c = 1; c < seen.size(); ++c) {
      const SE3 truth = room.room_from_camera[0].inverse() * room.room_from_camera[c];
      const SE3 found = to_se3(solved->rig.cameras[c].rig_from_camera);
      EXPECT_LT((found.translation - truth.translation).norm(), 0.005);
      EXPECT_LT(log_so3(found.rotation * truth.rotation.transpose()).norm(), 0.002);
      EXPECT_EQ(solved->rig.cameras[c].calibration.parameters[0].value, room.cameras[c].fx());
    }
  }
}

// How far a camera is from the first one, and what is said of the error of that.
struct Length {
  double value = 0;
  double sigma = 0;
};
Length length_of(const LightSolution& solved, std::size_t camera) {
  const auto& place = solved.rig.cameras[camera].rig_from_camera.translation;
  const Eigen::Vector3d at(place[0], place[1], place[2]);
  const auto n = static_cast<Eigen::Index>(solved.names.size());
  Eigen::VectorXd along = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::string& name = solved.names[static_cast<std::size_t>(i)];
    for (const auto& [end, k] : {std::pair(".tx", 0), {".ty", 1}, {".tz", 2}}) {
      const double unit = at[k] / at.norm();
      if (name == "cam" + std::to_string(camera) + end) along[i] += unit;
      if (name == std::string("cam0") + end) along[i] -= unit;
    }
  }
  const Eigen::Map<const Eigen::MatrixXd> covariance(solved.covariance.data(), n, n);
  return {at.norm(), std::sqrt(std::max(0.0, along.dot(covariance * along)))};
}

// A distance that is known to some millimetres makes all lengths as well known as itself: a tape
// that is wrong by its sigma is wrong so in all of them, and nothing else is.
TEST(LightSolve, LengthsAreAsWellKnownAsTheDistance) {
  constexpr double kSigma = 0.02;  // m
  Random random(12);
  const LitRoom room = scenes::lit_room(5, random);
  const auto seen = scenes::see_lights(room, scenes::lights_in(room, 400, random), random);
  const auto distance_of = [&](std::size_t camera) {
    return (room.room_from_camera[camera].translation - room.room_from_camera[0].translation)
        .norm();
  };
  const double known = distance_of(2);
  LightOptions exact;
  set_known_distance({"cam0", "cam2", known, 0}, exact);
  LightOptions taped;
  set_known_distance({"cam0", "cam2", known + kSigma, kSigma}, taped);
  const auto once = solve_light(seen, exact);
  const auto again = solve_light(seen, taped);
  ASSERT_TRUE(once.has_value()) << once.error().message;
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_NEAR(length_of(*once, 2).value, known, 1e-9);
  EXPECT_LT(length_of(*once, 2).sigma, 1e-6);
  EXPECT_NEAR(length_of(*again, 2).value, known + kSigma, 1e-9);
  EXPECT_NEAR(length_of(*again, 2).sigma, kSigma, 1e-6);
  for (const std::size_t other : {1U, 3U, 4U}) {
    const Length taken = length_of(*again, other);
    const double by_tape = kSigma * taken.value / (known + kSigma);
    EXPECT_NEAR(taken.sigma, std::hypot(length_of(*once, other).sigma, by_tape), 0.02 * by_tape);
    EXPECT_LT(std::abs(taken.value - distance_of(other)), 4 * taken.sigma);
  }
}

// Some known, some not.
TEST(LightSolve, TakesWhatIsKnownOfSomeCameras) {
  Random random(10);
  const LitRoom room = scenes::lit_room(4, random);
  auto seen = scenes::see_lights(room, scenes::lights_in(room, 300, random), random);
  seen[2].calibration = room.cameras[2].to_calibration();
  const auto without = solve_light(scenes::see_lights(room, {}, random));
  EXPECT_FALSE(without.has_value());
  const auto solved = solve_light(seen);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->rig.cameras[2].calibration.parameters[0].value, room.cameras[2].fx());
  for (const std::size_t c : {0, 1, 3}) {
    const Parameter& fx = solved->rig.cameras[c].calibration.parameters[0];
    EXPECT_LT(std::abs(fx.value - room.cameras[c].fx()), 4.5 * fx.sigma.value());
  }
}

// ---- What is refused ----------------------------------------------------------------------------

void expect_refused(const Result<LightSolution>& solved, const char* words) {
  ASSERT_FALSE(solved.has_value()) << words;
  EXPECT_NE(solved.error().message.find(words), std::string::npos) << solved.error().message;
}

struct Scene {
  LitRoom room;
  std::vector<Eigen::Vector3d> lights;
  std::vector<LightCamera> seen;
};

Scene scene_of(int cameras, int instants) {
  Random random(11);
  Scene scene{scenes::lit_room(cameras, random), {}, {}};
  scene.lights = scenes::lights_in(scene.room, instants, random);
  scene.seen = scenes::see_lights(scene.room, scene.lights, random);
  return scene;
}

TEST(LightRefusals, TwoCamerasOfUnknownLenses) {
  expect_refused(solve_light(scene_of(2, 300).seen), "three are needed");
}

TEST(LightRefusals, TooFewInstants) {
  expect_refused(solve_light(scene_of(4, 15).seen), "move it for a minute");
}

TEST(LightRefusals, ALightInAPlane) {
  Scene scene = scene_of(4, 300);
  Random random(12);
  for (Eigen::Vector3d& light : scene.lights) light.z() = 0.3 * light.x();
  expect_refused(solve_light(scenes::see_lights(scene.room, scene.lights, random)),
                 "stayed in one plane");
}

TEST(LightRefusals, ACameraThatSeesAnotherPlace) {
  Scene scene = scene_of(5, 300);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (i % 40 != 0) scene.seen[3].seen[i].reset();
  }
  expect_refused(solve_light(scene.seen), "'cam3'");
}

TEST(LightRefusals, AMirroredPicture) {
  Scene scene = scene_of(5, 300);
  for (auto& seen : scene.seen[1].seen) {
    if (seen) seen->uv.u = scene.seen[1].image_size.width - 1 - seen->uv.u;
  }
  expect_refused(solve_light(scene.seen), "'cam1' is mirrored");
}

TEST(LightRefusals, MirroredPlaces) {
  const Scene scene = scene_of(5, 300);
  LightOptions options;
  options.places = places_of(scene.room, 5);
  for (CameraPlace& place : options.places) place.place[1] = -place.place[1];
  expect_refused(solve_light(scene.seen, options), "left-handed");
}

TEST(LightRefusals, PlacesThatTellNoFrame) {
  const Scene scene = scene_of(5, 300);
  LightOptions options;
  options.places = {{"cam0", {0, 0, 0}}, {"cam1", {1, 0, 0}}, {"cam2", {2, 0, 0}}};
  expect_refused(solve_light(scene.seen, options), "one line");
  options.places = {{"cam9", {0, 0, 0}}, {"cam1", {1, 0, 0}}};
  expect_refused(solve_light(scene.seen, options), "'cam9'");
  options.places = {{"cam0", {0, 0, 0}}};
  expect_refused(solve_light(scene.seen, options), "two for the unit");
}

TEST(LightRefusals, WhatDoesNotFitTogether) {
  Scene scene = scene_of(4, 100);
  LightOptions options;
  options.model = "fisheye";
  expect_refused(solve_light(scene.seen, options), "calibrations of cameras");
  options.model = "brown4";
  options.fix = {"k9"};
  expect_refused(solve_light(scene.seen, options), "'k9'");
  scene.seen[1].name = "cam0";
  expect_refused(solve_light(scene.seen), "give each its own");
  scene.seen[1].name = "cam1";
  scene.seen[1].seen.pop_back();
  expect_refused(solve_light(scene.seen), "instants");
  scene.seen[1].seen.push_back(LightPoint{{5000, 0}, 1});
  expect_refused(solve_light(scene.seen), "outside");
}

TEST(LightSolve, IsStopped) {
  std::stop_source source;
  source.request_stop();
  const auto solved = solve_light(scene_of(4, 300).seen, {}, source.get_token());
  ASSERT_FALSE(solved.has_value());
  EXPECT_EQ(solved.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace calvin
