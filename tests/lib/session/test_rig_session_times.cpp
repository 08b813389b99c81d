// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras that run freely: a board that moves, or jumps, is seen by each at another time.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>

#include "rig_sessions.hpp"

namespace calvin {
namespace {

using scenes::kFrame;
using scenes::Random;
using scenes::Sessions;

// A board that swings before two cameras of which one is 8 ms late: by its velocity that is known
// to each corner, and what is said of the result is so.
TEST(RigSessionTimes, AllowsForCamerasThatRunFreely) {
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
      // Frames that are lost leave intervals that are not even.
      if (n % 5 == 3 || n % 7 == 2) continue;
      (void)s.offer(1, at(n * kFrame + kLate), n * kFrame + kLate);
    }
    const auto job = s.session.take_solve(true);
    ASSERT_TRUE(job.has_value());
    const auto solved = solve_rig(views_of(*job), job->options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_EQ(solved->farthest, kLate);
    const SE3 truth = s.rig.world_from_camera[0].inverse() * s.rig.world_from_camera[1];
    squares += scenes::place_error(solved->rig.cameras[1], truth).square;
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / trials << '\n';
  EXPECT_GT(squares / trials, 0.6);
  EXPECT_LT(squares / trials, 1.5);
}

// A board that is put down in one place after another, and stills that are shown as a video: half
// of the way to a place is no velocity there. The cameras see it at other times.
TEST(RigSessionTimes, TakesABoardThatJumpsWhereItStands) {
  const int trials = scenes::full_count() ? 200 : 25;
  double squares = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Sessions s;
    Random random(40 + static_cast<std::uint64_t>(trial));
    std::vector<SE3> places;
    while (places.size() < 20) {
      places.push_back(
          {exp_so3({scenes::uniform(random, -0.4, 0.4), scenes::uniform(random, -0.4, 0.4), 0.3}),
           {scenes::uniform(random, -0.08, 0.08), scenes::uniform(random, -0.1, 0.0), 0.62}});
    }
    const auto at = [&](std::uint64_t ns) { return places[ns / (15 * kFrame) % places.size()]; };
    for (std::uint64_t n = 0; n < 15 * places.size(); ++n) {
      (void)s.offer(0, at(n * kFrame), n * kFrame);
      const auto late = static_cast<std::uint64_t>(scenes::uniform(random, 0, 3e6));
      (void)s.offer(1, at(n * kFrame + late), n * kFrame + late);
    }
    const auto job = s.session.take_solve(true);
    ASSERT_TRUE(job.has_value());
    const auto solved = solve_rig(views_of(*job), job->options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_LT(solved->rig.rms, 2 * s.rig.noise) << trial;
    ASSERT_EQ(solved->links.size(), 1U);
    EXPECT_GT(solved->links[0].views, 10U) << trial;
    const SE3 truth = s.rig.world_from_camera[0].inverse() * s.rig.world_from_camera[1];
    squares += scenes::place_error(solved->rig.cameras[1], truth).square;
  }
  EXPECT_GT(squares / trials, 0.6);
  EXPECT_LT(squares / trials, 1.5);
}

}  // namespace
}  // namespace calvin
