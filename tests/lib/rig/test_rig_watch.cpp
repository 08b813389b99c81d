// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A camera that is pushed while its rig is in use is told of by its name, how far and since when;
// one that nobody pushes is not.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/rig_watch.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::SimulatedRig;

constexpr std::uint64_t kSecond = 1'000'000'000;  // ns

std::vector<RigCameraViews> later(std::vector<RigCameraViews> seen, std::uint64_t by) {
  for (RigCameraViews& camera : seen) {
    for (View& view : camera.views) view.observation.timestamp += by;
  }
  return seen;
}

// A rig whose places are as they are.
Rig truth_of(const SimulatedRig& rig, const std::vector<RigCameraViews>& seen) {
  Rig truth;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    RigCamera camera;
    camera.calibration = seen[c].calibration;
    camera.rig_from_camera = to_pose(rig.world_from_camera[0].inverse() * rig.world_from_camera[c]);
    truth.cameras.push_back(camera);
  }
  return truth;
}

// Focal length and principal point off by what their covariance says.
Calibration about_known(Calibration calibration, Random& random) {
  constexpr double kSigmas[] = {0.5, 0.5, 1, 1};  // px
  std::normal_distribution<double> normal(0, 1);
  calibration.covariance.assign(16, 0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    calibration.parameters[i].sigma = kSigmas[i];
    calibration.parameters[i].value += kSigmas[i] * normal(random);
    calibration.covariance[5 * i] = kSigmas[i] * kSigmas[i];
  }
  return calibration;
}

// The discrepancies of a rig that is right are as large as their covariances say, by the corners
// alone and with lenses that are not known exactly.
TEST(RigWatch, DiscrepanciesAreAsLargeAsTheySay) {
  for (const bool is_exact : {true, false}) {
    double squares = 0;
    int count = 0;
    for (std::uint64_t trial = 0; trial < 40; ++trial) {
      Random random(trial);
      const SimulatedRig rig = scenes::ring_rig(4, random);
      auto seen = scenes::seen_by(rig, 12, 0.7, random);
      if (!is_exact) {
        for (RigCameraViews& one : seen) one.calibration = about_known(one.calibration, random);
      }
      const auto tests = rig::test_pairs(truth_of(rig, seen), seen, 10'000'000);
      ASSERT_TRUE(tests.has_value()) << tests.error().message;
      for (const rig::PairTest& test : *tests) {
        EXPECT_NE(test.camera, test.by);
        squares += test.discrepancy.square();
        ++count;
      }
    }
    std::cout << "mean of e^T C^-1 e / 6 = " << squares / count << " of " << count << '\n';
    EXPECT_GT(count, 150);
    // The noise of a pair is the larger of what the corners show and what the detector says.
    EXPECT_GT(squares / count, 0.75);
    EXPECT_LT(squares / count, 1.1);
  }
}

// How well a place of the rig itself is known is a part of it, also by the lever from the camera
// that both are seen by.
TEST(RigWatch, AllowsForErrorsOfTheRig) {
  constexpr double kTurn = 0.003;   // rad
  constexpr double kPlace = 0.002;  // m
  double squares = 0;
  int count = 0;
  for (std::uint64_t trial = 0; trial < 60; ++trial) {
    Random random(trial);
    std::normal_distribution<double> normal(0, 1);
    const SimulatedRig rig = scenes::ring_rig(4, random);
    const auto seen = scenes::seen_by(rig, 3, 0.7, random);
    Rig known = truth_of(rig, seen);
    for (std::size_t c = 1; c < 4; ++c) {
      SE3 place = to_se3(known.cameras[c].rig_from_camera);
      Eigen::Vector3d turn;
      for (int i = 0; i < 3; ++i) {
        turn(i) = kTurn * normal(random);
        place.translation(i) += kPlace * normal(random);
      }
      place.rotation = exp_so3(turn) * place.rotation;
      known.cameras[c].rig_from_camera = to_pose(place);
      known.cameras[c].covariance.assign(36, 0.0);
      for (std::size_t i = 0; i < 6; ++i) {
        known.cameras[c].covariance[7 * i] = std::pow(i < 3 ? kTurn : kPlace, 2);
      }
    }
    const auto tests = rig::test_pairs(known, seen, 10'000'000);
    for (const rig::PairTest& test : *tests) {
      squares += test.discrepancy.square();
      ++count;
    }
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / count << " of " << count << '\n';
  EXPECT_GT(squares / count, 0.8);
  EXPECT_LT(squares / count, 1.2);
}

// A frame in which the board was misread, by far: that is no camera that has moved, however sure it
// seems.
TEST(RigWatch, OneBadFrameIsNotTold) {
  Random random(3);
  const SimulatedRig rig = scenes::stereo_rig(random);
  const auto before = scenes::seen_by(rig, 30, 0.7, random);
  const auto solved = solve_rig(before);
  ASSERT_TRUE(solved.has_value());
  const WatchedRig watched = watched_rig(solved->rig, before, {});
  auto after = later(scenes::seen_by(rig, 30, 0.7, random), 1000 * kSecond);
  std::vector<View>& misread = after[1].views;
  ASSERT_GT(misread.size(), 10U);
  for (Pixel& at : misread[misread.size() / 2].observation.uv) at.u += 40;
  RigWatch watch;
  EXPECT_TRUE(watch.look(watched, {}, after, 10'000'000).empty());
}

struct Kind {
  const char* name;
  std::function<SimulatedRig(Random&)> make;
  int instants;  // from which the rig is solved
  int more;      // that come then
};
const Kind kKinds[] = {
    {"Stereo", [](Random& r) { return scenes::stereo_rig(r); }, 25, 20},
    {"RingOfFour", [](Random& r) { return scenes::ring_rig(4, r); }, 60, 120},
    {"Chain", [](Random& r) { return scenes::chain_rig(4, r); }, 150, 400},
};

class Watched : public ::testing::TestWithParam<Kind> {
 protected:
  struct Told {
    std::vector<MovedCamera> all;
    std::vector<std::string> excluded;
    std::vector<std::uint64_t> instants;  // at which the camera that is pushed sees what others do
  };
  // The rig by what was seen before, then what is seen after the push, in portions.
  static Told watch(const SimulatedRig& rig, const SimulatedRig& pushed, std::size_t which,
                    Random& random) {
    const Kind& kind = GetParam();
    const auto before = scenes::seen_by(rig, kind.instants, 0.7, random);
    const auto solved = solve_rig(before);
    EXPECT_TRUE(solved.has_value()) << solved.error().message;
    const WatchedRig watched = watched_rig(solved->rig, before, {});
    RigWatch watch;
    Told told;
    for (int portion = 0; portion < kind.more / 5; ++portion) {
      const auto after = later(scenes::seen_by(pushed, 5, 0.7, random),
                               (1000 + 10 * static_cast<std::uint64_t>(portion)) * kSecond);
      for (const Instant& instant : pair_instants(after, 10'000'000).instants) {
        if (std::ranges::find(instant.views, which, &RigView::camera) != instant.views.end()) {
          told.instants.push_back(instant.timestamp);
        }
      }
      for (MovedCamera& moved : watch.look(watched, told.excluded, after, 10'000'000)) {
        for (const std::string& name : moved.cameras) told.excluded.push_back(name);
        told.all.push_back(std::move(moved));
      }
    }
    return told;
  }
};
INSTANTIATE_TEST_SUITE_P(Rig, Watched, ::testing::ValuesIn(kKinds),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Watched, NobodyPushedIsNotTold) {
  const int trials = scenes::full_count() ? 200 : 15;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(500 + static_cast<std::uint64_t>(trial));
    const SimulatedRig rig = GetParam().make(random);
    const Told told = watch(rig, rig, 0, random);
    EXPECT_TRUE(told.all.empty()) << trial << ": " << to_text(told.all.front());
  }
}

TEST_P(Watched, OnePushedIsToldByItsName) {
  constexpr double kTurn = 0.02;    // rad
  constexpr double kPlace = 0.015;  // m
  const int trials = scenes::full_count() ? 200 : 20;
  int named = 0;
  int in_pair = 0;
  int others = 0;
  int prompt = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(700 + static_cast<std::uint64_t>(trial));
    const SimulatedRig rig = GetParam().make(random);
    SimulatedRig pushed = rig;
    const std::size_t which = static_cast<std::size_t>(trial) % rig.cameras.size();
    SE3& place = pushed.world_from_camera[which];
    const Eigen::Vector3d axis = Eigen::Vector3d(1, 0.5, -0.3).normalized();
    place.rotation = exp_so3(kTurn * axis) * place.rotation;
    place.translation += kPlace * Eigen::Vector3d(0.6, -0.64, 0.48);
    const Told told = watch(rig, pushed, which, random);
    if (told.all.empty()) continue;
    const MovedCamera& first = told.all.front();
    const std::string name = "cam" + std::to_string(which);
    const bool is_it = std::ranges::find(first.cameras, name) != first.cameras.end();
    if (!is_it) {
      ++others;
    } else if (first.cameras.size() == 1) {
      ++named;
    } else {
      ++in_pair;
    }
    if (!is_it) continue;
    // Pairs that had too little in common are not watched, and some boards have two tilts.
    EXPECT_GE(first.since, told.instants.at(0)) << trial;
    prompt += first.since <= told.instants.at(2) ? 1 : 0;
    // By what a few instants say, and lenses that are known exactly.
    EXPECT_NEAR(first.turn, kTurn, 0.01) << trial;
    EXPECT_NEAR(first.place, kPlace, 0.01) << trial;
  }
  std::cout << named << " by name, " << in_pair << " as one of two, " << others
            << " by that of another, of " << trials << '\n';
  EXPECT_EQ(others, 0);
  EXPECT_GE(prompt, 0.8 * trials);
  if (GetParam().name == std::string("Stereo")) {
    EXPECT_EQ(in_pair, trials);
  } else {
    EXPECT_GE(named, 0.85 * trials);
  }
}

}  // namespace
}  // namespace calvin
