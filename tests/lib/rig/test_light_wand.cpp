// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras around a room in which a wand of two or three lights is moved: its lengths give the unit,
// and how well it is known is a part of every place. What contradicts them is refused or told.
#include <cmath>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "calvin/rig/solve_light.hpp"
#include "light_errors.hpp"

namespace calvin {
namespace {

using scenes::errors_of;
using scenes::LitRoom;
using scenes::Normalised;
using scenes::normalised;
using scenes::places_of;
using scenes::Random;

const std::vector<double> kTwo = {0, 0.5};
const std::vector<double> kThree = {0, 0.15, 0.5};

// A wand that is not quite what it is said to be.
std::vector<double> made(std::vector<double> places, double sigma, Random& random) {
  std::normal_distribution<double> off(0, sigma);
  for (std::size_t k = 1; k < places.size(); ++k) places[k] += off(random);
  return places;
}

struct Unit {
  double error = 0;  // of all lengths
  double sigma = 0;
};

// By how much the distances of cameras are too large, and what is said of that.
Unit unit_of(const LightSolution& solved, const Eigen::VectorXd& errors, const LitRoom& room) {
  const Eigen::Index n = errors.size();
  const Eigen::Map<const Eigen::MatrixXd> covariance(solved.covariance.data(), n, n);
  const SE3 world_from_room = room.room_from_camera.front().inverse();
  Eigen::VectorXd by = Eigen::VectorXd::Zero(n);
  double squares = 0;
  Eigen::Index number = 0;
  for (const std::string& name : solved.names) {
    const std::size_t camera = static_cast<std::size_t>(name[3] - '0');
    const Eigen::Vector3d at = (world_from_room * room.room_from_camera[camera]).translation;
    for (const auto& [end, k] : {std::pair(".tx", 0), {".ty", 1}, {".tz", 2}}) {
      if (!name.ends_with(end)) continue;
      by[number] = at[k];
      squares += at[k] * at[k];
    }
    ++number;
  }
  by /= squares;
  return {by.dot(errors), std::sqrt(by.dot(covariance * by))};
}

struct Case {
  int cameras;
  std::vector<double> wand;
  double sigma;  // m
  bool known;    // the lenses
  int trials;    // reduced
  int full_trials;
};
const Case kCases[] = {{2, kThree, 0.001, true, 12, 200},
                       {3, kTwo, 0.0005, false, 8, 200},
                       {4, kThree, 0.001, false, 4, 200},
                       {5, kTwo, 0, false, 4, 200}};

class Wand : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Cameras, Wand, ::testing::ValuesIn(kCases), [](const auto& test) {
  return std::to_string(test.param.cameras) + "AndLights" + std::to_string(test.param.wand.size());
});

// A fifth of the sightings is missing, and a tenth of the rest are reflections.
TEST_P(Wand, GivesTheUnitAsWellAsItSays) {
  const Case& kind = GetParam();
  const int trials = scenes::full_count() ? kind.full_trials : kind.trials;
  constexpr double kOffCenter = 0.01;
  Normalised all;
  double units = 0;
  double refused = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(700 + static_cast<std::uint64_t>(trial));
    LitRoom room = scenes::lit_room(kind.cameras, random, kOffCenter);
    const auto wand = made(kind.wand, kind.sigma, random);
    auto seen = scenes::see_lights(room, scenes::wands_in(room, wand, 300, random), random);
    for (std::size_t c = 0; c < seen.size() && kind.known; ++c) {
      seen[c].calibration = room.cameras[c].to_calibration();
    }
    LightOptions options;
    options.wand = kind.wand;
    options.wand_sigma = kind.sigma;
    options.center_sigma = kOffCenter;
    const auto solved = solve_light(seen, options);
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    EXPECT_TRUE(solved->rig.is_metric);
    EXPECT_EQ(solved->rig.world, "cam0");
    const auto errors = errors_of(*solved, room, room.room_from_camera.front().inverse());
    const Normalised one = normalised(*solved, errors);
    EXPECT_LT(one.largest, 4.5) << trial;
    all.square += one.square;
    all.degrees += one.degrees;
    const Unit unit = unit_of(*solved, errors, room);
    EXPECT_GE(unit.sigma, 0.95 * kind.sigma / kind.wand.back());
    units += unit.error * unit.error / (unit.sigma * unit.sigma);
    for (const LightCameraErrors& own : solved->errors) {
      refused += static_cast<double>(own.seen - own.used);
    }
    ASSERT_TRUE(solved->wand.has_value());
    EXPECT_GT(solved->wand->instants, 50u);
    EXPECT_LT(solved->wand->rms, 0.01);
  }
  std::cout << kind.cameras << " cameras, " << kind.wand.size() << " lights: e^T C^-1 e / "
            << all.degrees << " = " << all.square / all.degrees << ", of the unit "
            << units / trials << ", " << refused / trials << " sightings refused in each\n";
  // What so many unit normal numbers come to.
  EXPECT_NEAR(all.square / all.degrees, 1, std::max(0.2, 4 * std::sqrt(2 / all.degrees)));
  EXPECT_NEAR(units / trials, 1, std::max(0.2, 4 * std::sqrt(2.0 / trials)));
}

struct Scene {
  LitRoom room;
  std::vector<Eigen::Vector3d> lights;
  std::vector<LightCamera> seen;
  LightOptions options;
};

Scene scene_of(int cameras, const std::vector<double>& wand, std::uint64_t seed = 21,
               int instants = 200) {
  Random random(seed);
  Scene scene{scenes::lit_room(cameras, random), {}, {}, {}};
  scene.lights = scenes::wands_in(scene.room, wand, instants, random);
  scene.seen = scenes::see_lights(scene.room, scene.lights, random);
  scene.options.wand = wand;
  return scene;
}

// One error of the wand is that of all instants: more of them do not make it smaller.
TEST(WandUnit, IsKnownNoBetterThanTheWand) {
  for (const double sigma : {0.0, 0.002}) {
    Scene scene = scene_of(4, kTwo);
    scene.options.wand_sigma = sigma;
    const auto solved = solve_light(scene.seen, scene.options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    const auto errors = errors_of(*solved, scene.room, scene.room.room_from_camera[0].inverse());
    const Unit unit = unit_of(*solved, errors, scene.room);
    EXPECT_NEAR(unit.sigma, sigma / 0.5, 0.0004);
    EXPECT_LT(std::abs(unit.error), 0.001) << "the wand is as long as it is said to be";
  }
}

// Rigid lengths say of lenses what places of a light by themselves do not.
TEST(WandUnit, MakesFocalLengthsSurer) {
  const Scene scene = scene_of(3, kTwo);
  const auto with = solve_light(scene.seen, scene.options);
  const auto without = solve_light(scene.seen);
  ASSERT_TRUE(with.has_value()) << with.error().message;
  ASSERT_TRUE(without.has_value()) << without.error().message;
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_LT(*with->rig.cameras[c].calibration.parameters[0].sigma,
              0.8 * *without->rig.cameras[c].calibration.parameters[0].sigma);
  }
}

// A mirror shows all cameras a light at the same wrong place: rays agree on it, the wand does not.
TEST(WandSightings, OfALightInAMirrorAreRefused) {
  Scene scene = scene_of(4, kThree);
  Random random(22);
  for (std::size_t i = 0; i < scene.lights.size(); i += 30) scene.lights[i + 2].z() += 0.3;
  const auto seen = scenes::see_lights(scene.room, scene.lights, random);
  const auto solved = solve_light(seen, scene.options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  std::size_t others = 0;
  for (std::size_t i = 0; i < scene.lights.size(); i += 30) {
    const bool has_all = solved->points[i] && solved->points[i + 1];
    others += has_all ? 1 : 0;
    for (std::size_t c = 0; c < seen.size(); ++c) {
      if (!has_all) continue;
      EXPECT_FALSE(solved->used[c][i + 2]) << c << i;
    }
  }
  EXPECT_GT(others, 10u) << "the other two lights are where they are";
}

// Of two lights nothing tells that their distance is wrong; with a third one in between what does
// not fit is told.
TEST(WandUnit, IsToldWhereAPartIsWrong) {
  Scene scene = scene_of(4, kThree);
  scene.options.wand = {0, 0.152, 0.5};
  const auto solved = solve_light(scene.seen, scene.options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  ASSERT_FALSE(solved->remarks.empty());
  EXPECT_NE(solved->remarks.front().find("measure the wand"), std::string::npos)
      << solved->remarks.front();
}

// Known places give the frame, and the wand the unit.
TEST(WandUnit, IsComparedToKnownPlaces) {
  Scene scene = scene_of(4, kTwo);
  scene.options.places = places_of(scene.room, 4);
  const auto solved = solve_light(scene.seen, scene.options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->rig.world, kPlacesWorld);
  EXPECT_TRUE(solved->remarks.empty()) << solved->remarks.front();
  const auto errors = errors_of(*solved, scene.room);
  EXPECT_LT(normalised(*solved, errors).largest, 4.5);
  for (const std::size_t known : {4, 2}) {
    scene.options.places = places_of(scene.room, known);
    for (CameraPlace& place : scene.options.places) {
      for (double& x : place.place) x *= 1.04;
    }
    const auto contradicted = solve_light(scene.seen, scene.options);
    ASSERT_TRUE(contradicted.has_value()) << contradicted.error().message;
    ASSERT_EQ(contradicted->remarks.size(), 1u) << known;
    EXPECT_NE(contradicted->remarks.front().find("mm long, not 500.0 mm"), std::string::npos)
        << contradicted->remarks.front();
    const auto off = errors_of(*contradicted, scene.room,
                               known == 2 ? scene.room.room_from_camera[0].inverse() : SE3());
    EXPECT_LT(known == 2 ? off.cwiseAbs().tail<3>().maxCoeff() : 0, 0.02) << "as by the wand";
  }
}

// ---- What is refused ----------------------------------------------------------------------------

void expect_refused(const Result<LightSolution>& solved, const char* words) {
  ASSERT_FALSE(solved.has_value()) << words;
  EXPECT_NE(solved.error().message.find(words), std::string::npos) << solved.error().message;
}

TEST(WandRefusals, LightsThatAreNotWhereTheyWereSaidToBe) {
  Scene scene = scene_of(4, kThree);
  scene.options.wand = {0, 0.35, 0.5};
  expect_refused(solve_light(scene.seen, scene.options), "lights 0 and 1 150");
}

TEST(WandRefusals, LightsThatAreSeldomSeenTogether) {
  Scene scene = scene_of(4, kTwo);
  for (LightCamera& camera : scene.seen) {
    for (std::size_t i = 0; i < camera.seen.size(); ++i) {
      if (i % 4 == 1 || i % 4 == 2) camera.seen[i].reset();
    }
  }
  expect_refused(solve_light(scene.seen, scene.options), "Two lights of the wand were seen");
}

TEST(WandRefusals, PlacesInMillimetres) {
  Scene scene = scene_of(4, kTwo);
  for (const std::size_t known : {4, 2}) {
    scene.options.places = places_of(scene.room, known);
    for (CameraPlace& place : scene.options.places) {
      for (double& x : place.place) x *= 1000;
    }
    expect_refused(solve_light(scene.seen, scene.options), "they are in millimetres");
  }
}

TEST(WandRefusals, LightsOfNoWand) {
  Scene scene = scene_of(4, kTwo);
  Random random(23);
  scene.lights = scenes::lights_in(scene.room, 400, random);
  expect_refused(solve_light(scenes::see_lights(scene.room, scene.lights, random), scene.options),
                 "not rigid");
}

TEST(WandRefusals, WandsThatAreNone) {
  Scene scene = scene_of(3, kTwo);
  const auto refused = [&](std::vector<double> wand, double sigma, const char* words) {
    scene.options.wand = std::move(wand);
    scene.options.wand_sigma = sigma;
    expect_refused(solve_light(scene.seen, scene.options), words);
    ASSERT_FALSE(check(scene.options).has_value());
  };
  refused({0}, 0, "tells no length");
  refused({0, -0.5}, 0, "rise from 0");
  refused({0, 0.5, 0.5}, 0, "rise from 0");
  refused({0.1, 0.5}, 0, "rise from 0");
  refused({0, std::nan("")}, 0, "rise from 0");
  refused({0, 0.5}, 0.1, "to a tenth of that");
  refused({0, 0.5}, -1, "to a tenth of that");
  scene.options = {};
  scene.options.wand = {0, 0.1, 0.2};
  expect_refused(solve_light(scene.seen, scene.options), "a place for each");
}

// What observations say of a wand: ids are the numbers of its lights.
TEST(WandSightings, HaveTheNumbersOfTheirLights) {
  std::vector<Observation> seen(2);
  for (std::size_t c = 0; c < 2; ++c) {
    seen[c].camera = c == 0 ? "a" : "b";
    seen[c].image_size = {640, 480};
    seen[c].timestamp = 1000;
  }
  seen[0].ids = {2, 0};
  seen[0].uv = {{20, 21}, {10, 11}};
  seen[0].sigma = {0.2, 0.1};
  seen[1].ids = {1};
  seen[1].uv = {{30, 31}};
  const auto cameras = light_cameras(seen, 0, 3);
  ASSERT_TRUE(cameras.has_value()) << cameras.error().message;
  EXPECT_EQ(cameras->lights, 3u);
  ASSERT_EQ(cameras->cameras[0].seen.size(), 3u);
  EXPECT_EQ(cameras->cameras[0].seen[2]->uv.u, 20);
  EXPECT_EQ(cameras->cameras[0].seen[2]->sigma, 0.2);
  EXPECT_EQ(cameras->cameras[0].seen[0]->uv.v, 11);
  EXPECT_FALSE(cameras->cameras[0].seen[1]);
  EXPECT_EQ(cameras->cameras[1].seen[1]->uv.u, 30);
  const auto fewer = light_cameras(seen, 0, 2);
  ASSERT_FALSE(fewer.has_value());
  EXPECT_NE(fewer.error().message.find("where all lights of the wand are"), std::string::npos);
}

}  // namespace
}  // namespace calvin
