// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What BlueCCal is tested with: four cameras and a light (MultiCamSelfCal, DATA20100906_134124).
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/blueccal.hpp"
#include "calvin/rig/solve_light.hpp"

namespace calvin {
namespace {

constexpr std::size_t kUseNthFrame = 2;  // as the configuration of the published numbers says

std::vector<LightCamera> strawlab() {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder =
      std::filesystem::path(data == nullptr ? "" : data) / "mcsc-strawlab-DATA20100906_134124";
  if (data == nullptr || !std::filesystem::exists(folder)) return {};
  const auto files = read_blueccal(folder);
  EXPECT_TRUE(files.has_value()) << files.error().message;
  std::vector<Observation> seen;
  for (const ObservationFile& file : *files) {
    for (const Observation& one : file.observations) {
      if (one.timestamp / 1'000'000'000 % kUseNthFrame == 0) seen.push_back(one);
    }
  }
  return light_cameras(seen, 0).value().cameras;
}

std::size_t places_in(const LightSolution& solved) {
  std::size_t count = 0;
  for (const auto& point : solved.points) count += point ? 1 : 0;
  return count;
}

// Published after its bundle adjustment: 522 places of the light, mean error 0.62 px.
TEST(RealLight, IsFittedBetterThanPublished) {
  const auto cameras = strawlab();
  if (cameras.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no mcsc-strawlab";
  ASSERT_EQ(cameras.size(), 4U);
  ASSERT_EQ(cameras.front().seen.size(), 563U);
  const auto solved = solve_light(cameras);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  std::cout << places_in(*solved) << " places, mean error " << solved->mean_error << " px\n";
  EXPECT_GE(places_in(*solved), 522U);
  EXPECT_LE(solved->mean_error, 0.62);
  for (const LightCameraErrors& own : solved->errors) {
    EXPECT_LE(own.mean, 0.62);
    EXPECT_GT(static_cast<double>(own.used), 0.85 * static_cast<double>(own.seen));
  }
}

// How far cameras move, of the largest distance, and focal lengths, in their sigmas, where some
// instants are left out.
struct Moved {
  double places = 0;
  double focal = 0;
};
template <typename IsLeftOut>
void leave_out(const std::vector<LightCamera>& cameras, const LightSolution& whole,
               const IsLeftOut& is_left_out, Moved& most) {
  auto some = cameras;
  for (LightCamera& camera : some) {
    for (std::size_t i = 0; i < camera.seen.size(); ++i) {
      if (is_left_out(i)) camera.seen[i].reset();
    }
  }
  const auto solved = solve_light(some);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const SE3 a = to_se3(whole.rig.cameras[c].rig_from_camera);
    const SE3 b = to_se3(solved->rig.cameras[c].rig_from_camera);
    most.places = std::max(most.places, (a.translation - b.translation).norm());
    const Parameter& f = whole.rig.cameras[c].calibration.parameters[0];
    const Parameter& g = solved->rig.cameras[c].calibration.parameters[0];
    most.focal = std::max(most.focal, std::abs(f.value - g.value) / f.sigma.value());
  }
}

// The frame is that of the first camera. A tenth is every tenth instant, or a stretch of time,
// whose errors have causes in common: that is told of.
TEST(RealLight, DoesNotHangOnATenthOfTheInstants) {
  const auto cameras = strawlab();
  if (cameras.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no mcsc-strawlab";
  const auto whole = solve_light(cameras);
  ASSERT_TRUE(whole.has_value()) << whole.error().message;
  EXPECT_GT(whole->scatter, 1);
  Moved by_tenths;
  Moved by_stretches;
  const std::size_t count = cameras.front().seen.size();
  for (std::size_t tenth = 0; tenth < 10; ++tenth) {
    leave_out(
        cameras, *whole, [&](std::size_t i) { return i % 10 == tenth; }, by_tenths);
    leave_out(
        cameras, *whole, [&](std::size_t i) { return 10 * i / count == tenth; }, by_stretches);
  }
  std::cout << "every tenth left out, places move by " << by_tenths.places << ", focal lengths by "
            << by_tenths.focal << " sigma; a stretch, by " << by_stretches.places << " and "
            << by_stretches.focal << " sigma\n";
  EXPECT_LT(by_tenths.places, 0.015);
  EXPECT_LT(by_tenths.focal, 1);
  EXPECT_LT(by_stretches.places, 0.03);
  EXPECT_LT(by_stretches.focal, 3);
}

}  // namespace
}  // namespace calvin
