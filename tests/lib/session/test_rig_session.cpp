// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which views a session of several cameras keeps, and when it solves.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "rig_sessions.hpp"

namespace calvin {
namespace {

using scenes::kFrame;
using scenes::Random;
using scenes::Sessions;

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
  settings.boards = {parse_board("puzzle:14x9:20mm").value()};
  s.session.start(settings);
  s.session.set_name(0, "cam0");
  s.session.set_name(1, "cam1");
  EXPECT_FALSE(s.offer(0, kPlace, 0));
  EXPECT_TRUE(s.session.progress().cameras.empty());
  // Who held up another one hears which.
  const std::string why = s.session.lack().message;
  EXPECT_NE(why.find(s.rig.board.text()), std::string::npos) << why;
  EXPECT_NE(why.find("puzzle:14x9:20mm"), std::string::npos) << why;
}

TEST(RigSession, CountsABoardHoweverItIsSpelled) {
  Sessions s;
  RigSessionSettings settings;
  settings.boards = {parse_board("puzzle:14x9:20mm").value(), s.rig.board};
  s.session.start(settings);
  s.session.set_name(0, "cam0");
  Observation seen = s.seen(0, kPlace, 0).value();
  ASSERT_EQ(seen.board, "checkerboard:9x6:25mm");
  seen.board = "checkerboard:9x6:2.5cm";
  EXPECT_TRUE(s.session.offer(0, seen).value());
}

// Of a camera that is not there nothing counts.
TEST(RigSession, TakesNothingOfACameraWithoutAName) {
  Sessions s;
  s.session.remove(1);
  EXPECT_TRUE(s.offer(0, kPlace, 0));
  EXPECT_FALSE(s.offer(1, kPlace, 0));
  EXPECT_EQ(s.session.progress().cameras, std::vector<std::string>{"cam0"});
  EXPECT_EQ(s.session.names(), std::vector<std::string>{"cam0"});
}

// The frame that was asked for may be that of a camera that goes, or never comes: the rig is found
// all the same, in another one.
TEST(RigSession, SolvesWithoutTheCameraOfTheWorld) {
  Sessions s;
  RigSessionSettings settings;
  settings.options.world = RigWorld{"cam9", {}, {}};
  s.session.start(settings);
  for (std::size_t c = 0; c < 2; ++c) {
    s.session.set_name(c, "cam" + std::to_string(c));
    s.session.set_intrinsics(c, s.rig.cameras[c].to_calibration());
    EXPECT_TRUE(s.offer(c, kPlace, 0));
  }
  const auto job = s.session.take_solve(true);
  ASSERT_TRUE(job.has_value());
  EXPECT_FALSE(job->options.world.has_value());
  ASSERT_EQ(job->remarks.size(), 1U);
  EXPECT_NE(job->remarks[0].find("'cam9'"), std::string::npos);
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
  broken = s.seen(0, kPlace, 0).value();
  broken.board = "lines:25mm";
  const auto nameless = s.session.offer(0, broken);
  ASSERT_FALSE(nameless.has_value());
  EXPECT_EQ(nameless.error().code, ErrorCode::kUnsupported);
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
      const auto solved = solve_rig(views_of(*job), job->options);
      if (solved) s.session.solved(*job, scenes::watched(*job, *solved));
    }
  }
  EXPECT_GE(jobs, 4);
  EXPECT_LE(jobs, 25);
  const auto last = s.session.take_solve(true);
  ASSERT_TRUE(last.has_value());
  const auto solved = solve_rig(views_of(*last), last->options);
  ASSERT_TRUE(solved.has_value());
  s.session.solved(*last, scenes::watched(*last, *solved));
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
  for (const RigJob::Camera& camera : job->cameras) {
    EXPECT_GT(camera.views.size(), 100U);
    EXPECT_LE(camera.views.size(), 601U);
  }
}

// Numbers of cameras may have gaps, one that sees nothing keeps the others from nothing and is
// named, a camera may go, and one may come back with another size.
TEST(RigSession, HasTheCamerasThatAreThere) {
  Sessions s;
  s.session.set_name(5, "late");
  EXPECT_TRUE(s.offer(0, kPlace, 0));
  EXPECT_TRUE(s.offer(1, kPlace, 1'000'000));
  const auto without = s.session.take_solve(true);
  ASSERT_TRUE(without.has_value());
  EXPECT_EQ(without->cameras.size(), 2U);
  ASSERT_EQ(without->left_out.size(), 1U);
  EXPECT_EQ(without->left_out[0].camera, "late");
  EXPECT_NE(without->left_out[0].reason.find("has seen no board"), std::string::npos);
  s.session.remove(5);
  const auto job = s.session.take_solve(true);
  ASSERT_TRUE(job.has_value());
  EXPECT_EQ(job->cameras.size(), 2U);
  EXPECT_TRUE(job->left_out.empty());
  Observation other = s.seen(0, kOther, kFrame).value();
  other.image_size = {1400, 1000};
  EXPECT_TRUE(s.session.offer(0, other).value());
  EXPECT_EQ(s.session.progress().links.size(), 0U);
}

// A job takes the views as they are: it costs the thread that takes it no copy of them.
TEST(RigSession, SharesItsViewsWithAJob) {
  Sessions s;
  (void)s.offer(0, kPlace, kFrame);
  (void)s.offer(1, kPlace, kFrame);
  const auto one = s.session.take_solve(true);
  const auto other = s.session.take_solve(true);
  ASSERT_TRUE(one.has_value() && other.has_value());
  EXPECT_EQ(one->cameras.at(0).views.at(0).get(), other->cameras.at(0).views.at(0).get());
  EXPECT_EQ(one->cameras.at(0).calibration.get(), other->cameras.at(0).calibration.get());
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
