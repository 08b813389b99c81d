// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A session of several cameras of which one is pushed: it is kept apart until it is inserted again.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "rig_sessions.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::Sessions;
using scenes::SimulatedRig;

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
    session.solved(*job, scenes::watched(*job, *solved));
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
TEST(PushedCamera, InsertsACameraThatWasPushedAgain) {
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

// A camera that was pushed while the first rig was being solved is told of as one that is pushed
// later: what was seen before that rig is looked at by it.
TEST(PushedCamera, NoticesAPushBeforeTheFirstRig) {
  PushedSession s;
  const SE3 before = s.rig.world_from_camera[2];
  s.show(100);
  const auto job = s.session.take_solve(false);
  ASSERT_TRUE(job.has_value());
  s.push();
  const std::uint64_t pushed_at = s.now;
  s.show(140);
  EXPECT_FALSE(s.look().has_value());
  const auto solved = solve_rig(views_of(*job), job->options);
  ASSERT_TRUE(solved.has_value());
  s.session.solved(*job, scenes::watched(*job, *solved));
  s.show(1);
  const auto moved = s.look();
  ASSERT_TRUE(moved.has_value());
  EXPECT_EQ(moved->cameras, std::vector<std::string>{"cam2"});
  EXPECT_GE(moved->since, pushed_at);
  const auto as_it_was = s.solve();
  ASSERT_TRUE(as_it_was.has_value());
  EXPECT_TRUE(as_it_was->rejected.empty());
  EXPECT_LT(s.sigmas_of(*as_it_was, 2, before), 4.5);
}

// Of two cameras that see the same either may have been pushed: whichever is inserted again, what
// the other one has seen counts on.
TEST(PushedCamera, InsertsEitherOfTwo) {
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
    s.session.solved(*first, scenes::watched(*first, *before));
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
TEST(PushedCamera, SaysThatACameraIsKeptApart) {
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
TEST(PushedCamera, InsertsACameraThatNothingWasSaidOf) {
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

}  // namespace
}  // namespace calvin
