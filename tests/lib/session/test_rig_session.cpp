// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which views a session of several cameras keeps, when it solves, and that the times of cameras
// that run freely are allowed for.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "calvin/session/rig/rig_session.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::SimulatedRig;

constexpr std::uint64_t kFrame = 33'000'000;  // ns

// A session of a stereo rig whose cameras are known.
struct Sessions {
  explicit Sessions(RigMode mode = RigMode::kJoint, std::uint64_t tolerance = 10'000'000) {
    Random random(1);
    rig = scenes::stereo_rig(random);
    RigSessionSettings settings;
    settings.options = {mode, tolerance};
    session.start(settings);
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      session.set_name(c, "cam" + std::to_string(c));
      session.set_intrinsics(c, rig.cameras[c].to_calibration());
    }
  }
  // What a camera sees of a board at a time, if it sees it.
  std::optional<Observation> seen(std::size_t camera, const SE3& world_from_board,
                                  std::uint64_t timestamp) {
    const SE3 pose = rig.world_from_camera[camera].inverse() * world_from_board;
    if (!scenes::faces(pose) || !scenes::sees_all(rig.cameras[camera], rig.board, pose)) {
      return std::nullopt;
    }
    View view = scenes::observe(rig.cameras[camera], rig.board, pose, rig.noise, noise);
    view.observation.timestamp = timestamp;
    return view.observation;
  }
  bool offer(std::size_t camera, const SE3& world_from_board, std::uint64_t timestamp) {
    const auto observation = seen(camera, world_from_board, timestamp);
    return observation && session.offer(camera, *observation).value();
  }
  SimulatedRig rig;
  RigSession session;
  Random noise{7};
};

const SE3 kPlace = {exp_so3({0.3, 0.1, 0.2}), {-0.04, -0.06, 0.6}};
const SE3 kOther = {exp_so3({-0.2, 0.3, 0.1}), {0.0, -0.02, 0.5}};

// Of a board that lies still one view is enough; where it was moved it is kept with that of the
// other camera, whichever came first.
TEST(RigSession, KeepsNewPlacesAndWhatGoesWithThem) {
  Sessions s;
  EXPECT_TRUE(s.offer(0, kPlace, 0));
  EXPECT_TRUE(s.offer(1, kPlace, 2'000'000));
  for (std::uint64_t n = 1; n < 10; ++n) {
    EXPECT_FALSE(s.offer(0, kPlace, n * kFrame));
    EXPECT_FALSE(s.offer(1, kPlace, n * kFrame + 2'000'000));
  }
  EXPECT_TRUE(s.offer(1, kOther, 20 * kFrame));
  EXPECT_TRUE(s.offer(0, kOther, 20 * kFrame + 2'000'000));
  const RigProgress progress = s.session.progress();
  ASSERT_EQ(progress.links.size(), 1U);
  EXPECT_EQ(progress.links[0].views, 2);
  EXPECT_EQ(progress.weakest, "cam0 cam1");
}

// A camera for which the board is not new gives its view all the same, also where it came first.
TEST(RigSession, TakesTheViewBeforeThatWasNotNew) {
  Sessions s;
  EXPECT_TRUE(s.offer(0, kPlace, 0));
  EXPECT_FALSE(s.offer(0, kPlace, 5 * kFrame));
  EXPECT_TRUE(s.offer(1, kPlace, 5 * kFrame + 1'000'000));
  EXPECT_EQ(s.session.progress().links.at(0).views, 1);
}

TEST(RigSession, CountsOnlyTheBoardThatWasAskedFor) {
  Sessions s;
  RigSessionSettings settings;
  settings.board = "puzzle:14x9:20mm";
  s.session.start(settings);
  EXPECT_FALSE(s.offer(0, kPlace, 0));
  EXPECT_TRUE(s.session.progress().cameras.empty());
}

TEST(RigSession, RefusesWhatIsNoView) {
  Sessions s;
  Observation broken = s.seen(0, kPlace, 0).value();
  broken.ids[3] = 1000;
  EXPECT_FALSE(s.session.offer(0, broken).has_value());
  broken = s.seen(0, kPlace, 0).value();
  std::swap(broken.ids[0], broken.ids[1]);
  EXPECT_FALSE(s.session.offer(0, broken).has_value());
  broken.board = "no board";
  EXPECT_FALSE(s.session.offer(0, broken).has_value());
}

// Held in many places a session asks for a solve, again with more, and at the end.
TEST(RigSession, SolvesAgainWithMoreViews) {
  Sessions s;
  Random random(5);
  int jobs = 0;
  for (std::uint64_t n = 0; n < 60; ++n) {
    const SE3 place = scenes::held_board(s.rig, 0.6, random);
    for (std::size_t c = 0; c < 2; ++c) (void)s.offer(c, place, n * 40 * kFrame);
    if (const auto job = s.session.take_solve(false)) {
      ++jobs;
      const auto solved = solve_rig(job->cameras, job->options);
      s.session.solved(*job, solved.has_value());
    }
  }
  EXPECT_GE(jobs, 4);
  EXPECT_LE(jobs, 25);
  const auto last = s.session.take_solve(true);
  ASSERT_TRUE(last.has_value());
  const auto solved = solve_rig(last->cameras, last->options);
  ASSERT_TRUE(solved.has_value());
  s.session.solved(*last, true);
  EXPECT_TRUE(s.session.is_solved());
  EXPECT_FALSE(s.session.take_solve(true).has_value());
  const SE3 truth = s.rig.world_from_camera[0].inverse() * s.rig.world_from_camera[1];
  EXPECT_LT(scenes::place_error(solved->rig.cameras[1], truth).largest, 4);
}

// Any stream takes the same memory.
TEST(RigSession, ForgetsWhatWouldBeTooMuch) {
  Sessions s;
  Random random(6);
  for (std::uint64_t n = 0; n < 3000; ++n) {
    const SE3 place = scenes::held_board(s.rig, 0.9, random);
    for (std::size_t c = 0; c < 2; ++c) (void)s.offer(c, place, n * 40 * kFrame);
  }
  const auto job = s.session.take_solve(true);
  ASSERT_TRUE(job.has_value());
  for (const RigCameraViews& camera : job->cameras) {
    EXPECT_GT(camera.views.size(), 100U);
    EXPECT_LE(camera.views.size(), 601U);
  }
}

// A board that swings before two cameras of which one is 8 ms late: by its velocity that is known
// to each corner, and what is said of the result is so.
TEST(RigSession, AllowsForCamerasThatRunFreely) {
  constexpr std::uint64_t kLate = 8'000'000;  // ns
  double squares = 0;
  const int trials = scenes::full_count() ? 200 : 25;
  for (int trial = 0; trial < trials; ++trial) {
    Sessions s;
    Random random(20 + static_cast<std::uint64_t>(trial));
    const double phases[] = {scenes::uniform(random, 0, 6), scenes::uniform(random, 0, 6),
                             scenes::uniform(random, 0, 6), scenes::uniform(random, 0, 6)};
    const auto at = [&](std::uint64_t ns) {
      const double t = 1e-9 * static_cast<double>(ns);
      const auto swing = [&](std::size_t i, double rate) { return std::sin(rate * t + phases[i]); };
      return SE3{exp_so3({0.4 * swing(0, 1.1), 0.4 * swing(1, 0.9), 0.3}),
                 {0.0 + 0.08 * swing(2, 0.8), -0.05 + 0.05 * swing(3, 1.0), 0.62}};
    };
    for (std::uint64_t n = 0; n < 900; ++n) {
      (void)s.offer(0, at(n * kFrame), n * kFrame);
      (void)s.offer(1, at(n * kFrame + kLate), n * kFrame + kLate);
    }
    const auto job = s.session.take_solve(true);
    ASSERT_TRUE(job.has_value());
    const auto solved = solve_rig(job->cameras, job->options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_EQ(solved->farthest, kLate);
    const SE3 truth = s.rig.world_from_camera[0].inverse() * s.rig.world_from_camera[1];
    squares += scenes::place_error(solved->rig.cameras[1], truth).square;
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / trials << '\n';
  EXPECT_LT(squares / trials, 3);
}

// Numbers of cameras may have gaps, a camera may go, and one may come back with another size.
TEST(RigSession, HasTheCamerasThatAreThere) {
  Sessions s;
  s.session.set_name(5, "late");
  EXPECT_TRUE(s.offer(0, kPlace, 0));
  EXPECT_TRUE(s.offer(1, kPlace, 1'000'000));
  EXPECT_FALSE(s.session.take_solve(true).has_value());
  EXPECT_NE(s.session.lack().message.find("'late'"), std::string::npos);
  s.session.remove(5);
  const auto job = s.session.take_solve(true);
  ASSERT_TRUE(job.has_value());
  EXPECT_EQ(job->cameras.size(), 2U);
  Observation other = s.seen(0, kOther, kFrame).value();
  other.image_size = {1400, 1000};
  EXPECT_TRUE(s.session.offer(0, other).value());
  EXPECT_EQ(s.session.progress().links.size(), 0U);
}

TEST(RigSession, SaysWhatItLacks) {
  RigSession session;
  session.start({});
  EXPECT_NE(session.lack().message.find("sink_0"), std::string::npos);
  session.set_name(0, "left");
  session.set_name(1, "right");
  EXPECT_NE(session.lack().message.find("'left' has seen no board"), std::string::npos);
}

}  // namespace
}  // namespace calvin
