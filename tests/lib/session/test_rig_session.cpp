// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which views a session of several cameras keeps, and when it solves.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "rig_sessions.hpp"

namespace calvin {
namespace {

using scenes::kFrame;
using scenes::Random;
using scenes::Sessions;
using scenes::SimulatedRig;

// What the session is told of a solve.
std::shared_ptr<const WatchedRig> watched(const RigJob& job, const RigSolution& solved) {
  return std::make_shared<const WatchedRig>(watched_rig(solved.rig, views_of(job), job.options));
}

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
      if (solved) s.session.solved(*job, watched(*job, *solved));
    }
  }
  EXPECT_GE(jobs, 4);
  EXPECT_LE(jobs, 25);
  const auto last = s.session.take_solve(true);
  ASSERT_TRUE(last.has_value());
  const auto solved = solve_rig(views_of(*last), last->options);
  ASSERT_TRUE(solved.has_value());
  s.session.solved(*last, watched(*last, *solved));
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

// Three cameras in a row of which the last one is pushed.
struct PushedSession {
  PushedSession() : rig(scenes::chain_rig(3, random)) {
    session.start({});
    for (std::size_t c = 0; c < 3; ++c) {
      session.set_name(c, "cam" + std::to_string(c));
      session.set_intrinsics(c, rig.cameras[c].to_calibration());
    }
  }
  // What all cameras see, from the time `now` on.
  void show(int instants) {
    auto seen = scenes::seen_by(rig, instants, 0.7, random);
    for (std::size_t c = 0; c < 3; ++c) {
      for (View& view : seen[c].views) {
        view.observation.timestamp += now;
        (void)session.offer(c, view.observation);
      }
    }
    now += static_cast<std::uint64_t>(instants) * 1'000'000'000;
  }
  std::optional<RigSolution> solve() {
    const auto job = session.take_solve(true);
    if (!job) return std::nullopt;
    auto solved = solve_rig(views_of(*job), job->options);
    if (!solved) return std::nullopt;
    session.solved(*job, watched(*job, *solved));
    return *std::move(solved);
  }
  // The camera that is told of as moved, with that it is kept apart.
  std::optional<MovedCamera> look() {
    const auto job = session.take_watch();
    if (!job) return std::nullopt;
    const auto moved = watch.look(*job->rig, job->left_out, views_of(*job), job->tolerance);
    if (moved.empty() || !session.moved(*job, moved.front())) return std::nullopt;
    return moved.front();
  }
  void push() {
    rig.world_from_camera[2].rotation =
        exp_so3({0.01, 0.02, 0}) * rig.world_from_camera[2].rotation;
    rig.world_from_camera[2].translation += Eigen::Vector3d(0.01, -0.02, 0.01);
  }
  double sigmas_of(const RigSolution& solution, std::size_t camera, const SE3& place) {
    const SE3 truth = rig.world_from_camera[0].inverse() * place;
    return scenes::place_error(solution.rig.cameras[camera], truth).largest;
  }
  Random random{11};
  SimulatedRig rig;
  RigSession session;
  RigWatch watch;
  std::uint64_t now = 1'000'000'000;
};

// What a pushed camera sees is no part of the rig, which stays as it was, until it is asked for;
// then it stands where it does now, and the others where they did.
TEST(RigSession, InsertsACameraThatWasPushedAgain) {
  PushedSession s;
  const SE3 before = s.rig.world_from_camera[2];
  s.show(120);
  ASSERT_TRUE(s.solve().has_value());
  EXPECT_FALSE(s.look().has_value());
  s.show(60);
  EXPECT_FALSE(s.look().has_value());
  s.push();
  const std::uint64_t pushed_at = s.now;
  s.show(140);
  const auto moved = s.look();
  ASSERT_TRUE(moved.has_value());
  EXPECT_EQ(moved->cameras, std::vector<std::string>{"cam2"});
  EXPECT_GE(moved->since, pushed_at);
  s.show(60);
  EXPECT_FALSE(s.look().has_value());  // it is said once
  const auto as_it_was = s.solve();
  ASSERT_TRUE(as_it_was.has_value());
  EXPECT_LT(s.sigmas_of(*as_it_was, 2, before), 4.5);
  EXPECT_TRUE(as_it_was->rejected.empty());
  EXPECT_EQ(s.session.take_solve(true).has_value(), false);
  EXPECT_FALSE(s.session.reinsert("nobody"));
  EXPECT_TRUE(s.session.reinsert("cam2"));
  const auto job = s.session.take_solve(false);
  ASSERT_TRUE(job.has_value());
  EXPECT_TRUE(job->remarks.empty());
  const auto again = solve_rig(views_of(*job), job->options);
  ASSERT_TRUE(again.has_value());
  EXPECT_LT(s.sigmas_of(*again, 1, s.rig.world_from_camera[1]), 4.5);
  EXPECT_LT(s.sigmas_of(*again, 2, s.rig.world_from_camera[2]), 4.5);
  // The views of the others are all there still.
  EXPECT_EQ(again->links.at(0).views, as_it_was->links.at(0).views);
  EXPECT_TRUE(again->rejected.empty());
}

// Of two cameras that see the same either may have been pushed: whichever is inserted again, what
// the other one has seen counts on.
TEST(RigSession, InsertsEitherOfTwo) {
  for (const std::string name : {"cam0", "cam1"}) {
    Sessions s;
    Random random(15);
    RigWatch watch;
    std::uint64_t now = 1'000'000'000;
    const auto show = [&](int instants) {
      for (int n = 0; n < instants; ++n, now += 1'000'000'000) {
        const SE3 place = scenes::held_board(s.rig, 0.6, random);
        for (std::size_t c = 0; c < 2; ++c) (void)s.offer(c, place, now);
      }
    };
    show(40);
    const auto first = s.session.take_solve(true);
    const auto before = solve_rig(views_of(*first), first->options);
    ASSERT_TRUE(before.has_value()) << before.error().message;
    s.session.solved(*first, watched(*first, *before));
    s.rig.world_from_camera[1].translation += Eigen::Vector3d(0.01, 0.01, 0);
    show(40);
    const auto job = s.session.take_watch();
    ASSERT_TRUE(job.has_value());
    const auto moved = watch.look(*job->rig, job->left_out, views_of(*job), job->tolerance);
    ASSERT_EQ(moved.size(), 1U);
    EXPECT_EQ(moved[0].cameras, (std::vector<std::string>{"cam0", "cam1"}));
    EXPECT_TRUE(s.session.moved(*job, moved[0]));
    EXPECT_FALSE(s.session.moved(*job, moved[0]));
    EXPECT_TRUE(s.session.reinsert(name));
    EXPECT_FALSE(s.session.moved(*job, moved[0]));  // that was before
    const auto again = s.session.take_solve(true);
    ASSERT_TRUE(again.has_value());
    EXPECT_TRUE(again->remarks.empty());
    const std::size_t which = name == "cam0" ? 0 : 1;
    EXPECT_GT(again->cameras[1 - which].views.size(), 1.5 * again->cameras[which].views.size());
    const auto solved = solve_rig(views_of(*again), again->options);
    ASSERT_TRUE(solved.has_value());
    const SE3 truth = s.rig.world_from_camera[0].inverse() * s.rig.world_from_camera[1];
    EXPECT_LT(scenes::place_error(solved->rig.cameras[1], truth).largest, 4.5);
  }
}

// While it is apart the rig says so, and a solve that began before the insertion is of no use.
TEST(RigSession, SaysThatACameraIsKeptApart) {
  PushedSession s;
  s.show(120);
  ASSERT_TRUE(s.solve().has_value());
  s.push();
  s.show(140);
  ASSERT_TRUE(s.look().has_value());
  s.show(20);
  const auto job = s.session.take_solve(true);
  ASSERT_TRUE(job.has_value());
  ASSERT_EQ(job->remarks.size(), 1U);
  EXPECT_NE(job->remarks[0].find("'cam2' has moved"), std::string::npos);
  EXPECT_TRUE(s.session.is_current(*job));
  EXPECT_TRUE(s.session.reinsert("cam2"));
  EXPECT_FALSE(s.session.is_current(*job));
}

// Who knows that a camera was moved says so, and its views begin anew.
TEST(RigSession, InsertsACameraThatNothingWasSaidOf) {
  PushedSession s;
  s.show(100);
  ASSERT_TRUE(s.solve().has_value());
  s.push();
  EXPECT_TRUE(s.session.reinsert("cam2"));
  const auto without = s.solve();
  ASSERT_TRUE(without.has_value());
  EXPECT_EQ(without->rig.cameras.size(), 2U);
  s.show(60);
  const auto with = s.solve();
  ASSERT_TRUE(with.has_value());
  ASSERT_EQ(with->rig.cameras.size(), 3U);
  EXPECT_LT(s.sigmas_of(*with, 2, s.rig.world_from_camera[2]), 4.5);
}

// A job takes the views as they are: it costs the thread that takes it no copy of them.
TEST(RigSession, SharesItsViewsWithAJob) {
  PushedSession s;
  s.show(50);
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
