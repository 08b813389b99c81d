// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A session of several cameras before a light: which sightings it keeps, what it solves from them,
// and what it says where that cannot be.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "calvin/session/rig/light_rig.hpp"
#include "simulated_light.hpp"

namespace calvin {
namespace {

using scenes::LitRoom;
using scenes::Random;

constexpr std::uint64_t kFrame = 33'333'333;  // ns
constexpr std::uint64_t kBegin = 1'000'000'000;

// A session of cameras around a room through which a light is carried.
struct LightSession {
  explicit LightSession(int cameras, std::uint64_t seed = 1, RigSessionSettings settings = {})
      : random(seed), room(scenes::lit_room(cameras, random)), seen(room.cameras.size(), true) {
    start(std::move(settings));
  }
  void start(RigSessionSettings settings) {
    session.start(std::move(settings));
    for (std::size_t c = 0; c < room.cameras.size(); ++c) session.set_name(c, name_of(c));
  }
  static std::string name_of(std::size_t camera) { return "cam" + std::to_string(camera); }
  // What a camera sees at a time, `late` ns after the others.
  std::optional<Observation> look(std::size_t camera, std::uint64_t time) {
    const Eigen::Vector3d light = scenes::carried_light(room, 1e-9 * static_cast<double>(time));
    const auto at = scenes::sighting(room, camera, light, random);
    if (!at) return std::nullopt;
    Observation one;
    one.board = "dot";
    one.timestamp = time;
    one.image_size = room.cameras[camera].image_size();
    one.ids = {0};
    one.uv = {at->uv};
    one.sigma = {at->sigma};
    return one;
  }
  // Frames of all cameras, each by its own phase.
  void show(int frames, const std::vector<std::uint64_t>& late = {}) {
    for (int n = 0; n < frames; ++n, now += kFrame) {
      for (std::size_t c = 0; c < room.cameras.size(); ++c) {
        if (!seen[c]) continue;
        const auto one = look(c, now + (late.empty() ? 0 : late[c]));
        if (one) (void)session.offer(c, *one).value();
      }
    }
  }
  Result<RigSolution> solve() {
    const auto job = session.take_solve(true);
    if (!job) return tl::unexpected(session.lack());
    auto solved = solve_light_rig(*job);
    if (solved) session.solved(*job, nullptr);
    return solved;
  }

  Random random;
  LitRoom room;
  std::vector<bool> seen;  // cameras that see the light
  RigSession session;
  std::uint64_t now = kBegin;
};

RigSessionSettings with_places(const LitRoom& room) {
  RigSessionSettings settings;
  settings.light.places = scenes::places_of(room, room.cameras.size());
  return settings;
}

struct Errors {
  double square = 0;  // e^T C^-1 e / 6, mean of the cameras
  double largest = 0;
};
Errors errors_of(const Rig& rig, const LitRoom& room) {
  Errors errors;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const auto one = scenes::place_error(rig.cameras[c], room.room_from_camera[c]);
    errors.square += one.square / static_cast<double>(rig.cameras.size());
    errors.largest = std::max(errors.largest, one.largest);
  }
  return errors;
}

// Lenses and places, of cameras that look at one time and of such as run freely: there the light is
// allowed to move between their pictures, and what is said of the result is so.
TEST(LightRig, CamerasStandWhereTheyAre) {
  const int trials = scenes::full_count() ? 40 : 4;
  for (const bool is_free : {false, true}) {
    double square = 0;
    for (int trial = 0; trial < trials; ++trial) {
      LightSession s(5, 30 + static_cast<std::uint64_t>(trial));
      s.start(with_places(s.room));
      s.room.missing = is_free ? 0.05 : s.room.missing;
      s.room.reflections = is_free ? 0 : s.room.reflections;
      std::vector<std::uint64_t> late(s.room.cameras.size(), 0);
      for (std::size_t c = 0; is_free && c < late.size(); ++c) late[c] = c * 1'700'000;
      s.show(900, late);
      const auto solved = s.solve();
      ASSERT_TRUE(solved.has_value()) << solved.error().message;
      EXPECT_TRUE(s.session.is_solved());
      EXPECT_EQ(solved->rig.world, kPlacesWorld);
      EXPECT_EQ(solved->farthest, late.back());
      const Errors errors = errors_of(solved->rig, s.room);
      EXPECT_LT(errors.largest, 4.5) << trial;
      square += errors.square / trials;
    }
    std::cout << (is_free ? "free" : "at one time") << ": mean of e^T C^-1 e / 6 = " << square
              << '\n';
    EXPECT_GT(square, 0.5);
    EXPECT_LT(square, 1.6);
  }
}

// The first camera is the rig, links say what each pair has in common, and reflections are told.
TEST(LightRig, SaysWhatCamerasHaveInCommon) {
  LightSession s(4);
  s.show(500);
  const RigProgress progress = s.session.progress();
  EXPECT_EQ(progress.cameras.size(), 4U);
  ASSERT_EQ(progress.links.size(), 6U);
  const auto solved = s.solve();
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_FALSE(solved->rig.is_metric);
  EXPECT_EQ(solved->rig.world, "cam0");
  EXPECT_EQ(solved->rig.pairing_tolerance, RigOptions().tolerance);
  ASSERT_EQ(solved->links.size(), 6U);
  // One unit is the distance of the camera that is farthest from the first one.
  double unit = 0;
  for (const SE3& pose : s.room.room_from_camera) {
    unit = std::max(unit, (pose.translation - s.room.room_from_camera[0].translation).norm());
  }
  for (std::size_t k = 0; k < 6; ++k) {
    const RigLink& link = solved->links[k];
    EXPECT_EQ(link.views, static_cast<std::size_t>(progress.links[k].views));
    EXPECT_GT(link.agree, link.views / 2);
    EXPECT_LT(link.agree, link.views);
    const SE3& a = s.room.room_from_camera[link.a];
    const SE3& b = s.room.room_from_camera[link.b];
    const double distance = (a.translation - b.translation).norm() / unit;
    EXPECT_NEAR(link.distance, distance, 4.5 * link.distance_sigma + 1e-9) << k;
    EXPECT_LT(link.distance_sigma, 0.02) << k;
    EXPECT_NEAR(link.angle, std::acos(a.rotation.col(2).dot(b.rotation.col(2))), 0.05) << k;
  }
  ASSERT_TRUE(solved->weakest.has_value());
  EXPECT_GT(solved->rejected.size(), 50U);
}

// Two cameras of which both lenses are known are placed.
TEST(LightRig, PlacesTwoCamerasThatAreKnown) {
  LightSession s(2);
  s.show(300);
  const auto without = s.solve();
  ASSERT_FALSE(without.has_value());
  EXPECT_NE(without.error().message.find("link a third one"), std::string::npos);
  for (std::size_t c = 0; c < 2; ++c) {
    s.session.set_intrinsics(c, s.room.cameras[c].to_calibration());
  }
  const auto solved = s.solve();
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->rig.cameras[1].calibration.parameters[0].value, s.room.cameras[1].fx());
  EXPECT_NEAR(solved->links.at(0).distance, 1, 1e-9);
}

// A camera that has seen too little is named and keeps the others from nothing.
TEST(LightRig, LeavesOutWhatSharesTooLittle) {
  LightSession s(5);
  s.seen[2] = s.seen[4] = false;
  s.show(300);
  s.seen[2] = true;
  s.show(15);
  RigSessionSettings settings;
  const auto solved = s.solve();
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->rig.cameras.size(), 3U);
  ASSERT_EQ(solved->left_out.size(), 1U);
  EXPECT_EQ(solved->left_out[0].camera, "cam2");
  EXPECT_NE(solved->left_out[0].reason.find("at which 2 others did, and 20 are the fewest"),
            std::string::npos)
      << solved->left_out[0].reason;
  const auto job = s.session.take_solve(false);
  EXPECT_FALSE(job.has_value()) << "nothing has come since then";
  s.show(15);
  const auto again = s.session.take_solve(true);
  ASSERT_TRUE(again.has_value());
  ASSERT_EQ(again->left_out.size(), 1U);
  EXPECT_NE(again->left_out[0].reason.find("'cam4' has seen no light"), std::string::npos);
}

// Where too few would stay, or clocks run apart, the solve says so.
TEST(LightRig, SaysThatTooLittleWasSeen) {
  LightSession few(3);
  few.show(25);
  const auto solved = few.solve();
  ASSERT_FALSE(solved.has_value());
  EXPECT_NE(solved.error().message.find("move it for a minute"), std::string::npos)
      << solved.error().message;
  LightSession apart(3);
  apart.show(300, {0, 15'000'000, 0});
  const auto late = apart.solve();
  ASSERT_FALSE(late.has_value());
  EXPECT_NE(late.error().message.find("clocks agree"), std::string::npos) << late.error().message;
  LightSession blind(3);
  blind.seen[1] = false;
  blind.show(300);
  EXPECT_FALSE(blind.session.take_solve(true).has_value());
  EXPECT_NE(blind.session.lack().message.find("'cam1' has seen no light"), std::string::npos);
}

// By the method lights count or do not; where it is open, what was seen first decides.
TEST(LightRig, CountsLightsByTheMethod) {
  Observation board;
  board.board = "checkerboard:3x2:10mm";
  board.timestamp = kBegin;
  board.image_size = {1280, 960};
  board.ids = {0, 1, 2, 3, 4, 5};
  board.uv = {{100, 100}, {200, 100}, {300, 100}, {100, 200}, {200, 200}, {300, 200}};
  board.sigma = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
  struct Case {
    RigMethod method;
    bool board_first;
    bool takes_lights;
  };
  for (const Case& c : {Case{RigMethod::kAuto, true, false},
                        {RigMethod::kAuto, false, true},
                        {RigMethod::kBoards, false, false},
                        {RigMethod::kSvoboda, true, true}}) {
    RigSessionSettings settings;
    settings.method = c.method;
    LightSession s(3, 1, settings);
    s.room.missing = 0;
    s.room.reflections = 0;
    Observation light = board;
    light.board = "dot";
    light.ids = {0};
    light.uv = {{300, 300}};
    light.sigma = {0.1};
    light.timestamp += kFrame;
    if (c.board_first) (void)s.session.offer(0, board);
    EXPECT_EQ(s.session.offer(0, light).value(), c.takes_lights);
    board.timestamp += 2 * kFrame;
    for (Pixel& corner : board.uv) corner.u += 100;  // a place that is worth keeping
    EXPECT_EQ(s.session.offer(0, board).value(), !c.takes_lights);
  }
}

// Any stream takes the same memory, and sightings enough; progress is not told of every frame.
TEST(LightRig, ForgetsWhatWouldBeTooMuch) {
  LightSession s(3);
  s.room.missing = 0;
  std::size_t kept = 0;
  std::size_t told = 0;
  for (int n = 0; n < 6000; ++n, s.now += kFrame) {
    for (std::size_t c = 0; c < 3; ++c) {
      // All over the picture, so that most of it is new.
      Observation one;
      one.board = "dot";
      one.timestamp = s.now;
      one.image_size = s.room.cameras[c].image_size();
      one.ids = {0};
      one.uv = {{scenes::uniform(s.random, 0, one.image_size.width - 1),
                 scenes::uniform(s.random, 0, one.image_size.height - 1)}};
      one.sigma = {0.2};
      kept += s.session.offer(c, one).value() ? 1 : 0;
      told += s.session.take_progress() ? 1 : 0;
    }
  }
  EXPECT_GT(kept, 3000U);
  EXPECT_LT(told, 500U);
  const auto job = s.session.take_solve(true);
  ASSERT_TRUE(job.has_value());
  for (const RigJob::Camera& camera : job->cameras) {
    EXPECT_GE(camera.views.size(), 900U);
    EXPECT_LE(camera.views.size(), 2001U);
  }
}

}  // namespace
}  // namespace calvin
