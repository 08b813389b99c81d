// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras of which it is known how far their clocks are apart: boards that move tell it, and what
// is said of the errors is so.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/io/rig_io.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::SimulatedRig;
using scenes::Swing;

constexpr double kFrame = 1.0 / 30;  // s
constexpr double kSecond = 1e9;      // ns

SimulatedRig three_cameras(Random& random) {
  SimulatedRig rig = scenes::stereo_rig(random);
  rig.cameras.push_back(scenes::random_camera("fisheye", random));
  rig.world_from_camera.push_back({exp_so3({-0.05, 0.1, 0.02}), {-0.1, 0.05, 0.01}});
  return rig;
}

// What a camera sees at a time, with velocities by the frames before and after it, which have noise
// of their own.
std::optional<View> moving_view(const SimulatedRig& rig, std::size_t c, const Swing& swing,
                                double at, Random& random) {
  const auto seen_at = [&](double t) -> std::optional<View> {
    const SE3 pose = rig.world_from_camera[c].inverse() * swing.at(t);
    if (!scenes::faces(pose) || !scenes::sees_all(rig.cameras[c], rig.board, pose)) return {};
    return scenes::observe(rig.cameras[c], rig.board, pose, rig.noise, random);
  };
  const auto before = seen_at(at - kFrame);
  auto view = seen_at(at);
  const auto after = seen_at(at + kFrame);
  if (!before || !view || !after) return std::nullopt;
  for (std::size_t i = 0; i < view->observation.uv.size(); ++i) {
    const Pixel& from = before->observation.uv[i];
    const Pixel& to = after->observation.uv[i];
    view->observation.velocity.push_back(
        {(to.u - from.u) / (2 * kFrame), (to.v - from.v) / (2 * kFrame)});
  }
  return view;
}

// Every third of a second a picture of each camera; its clock says `offsets` s less than it should.
std::vector<RigCameraViews> seen_by_clocks(const SimulatedRig& rig,
                                           const std::vector<double>& offsets, int instants,
                                           Random& random) {
  const Swing swing(random);
  std::vector<RigCameraViews> all(rig.cameras.size());
  for (std::size_t c = 0; c < all.size(); ++c) {
    all[c].calibration = rig.cameras[c].to_calibration();
    all[c].calibration.camera = "cam" + std::to_string(c);
    const double phase = 0.003 * static_cast<double>(c);
    for (int n = 0; n < instants; ++n) {
      const double stamp = 1 + 10 * kFrame * n + phase;
      auto view = moving_view(rig, c, swing, stamp + offsets[c], random);
      if (!view) continue;
      view->observation.timestamp = static_cast<std::uint64_t>(std::llround(kSecond * stamp));
      all[c].views.push_back(*std::move(view));
    }
  }
  return all;
}

TEST(RigClocks, AreAsWellKnownAsTheySay) {
  const int trials = scenes::full_count() ? 400 : 25;
  double places = 0;
  double offsets = 0;
  double worst = 0;  // sigmas, of offsets
  double sigma = 0;  // s, the largest
  int cameras = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(50 + static_cast<std::uint64_t>(trial));
    const SimulatedRig rig = three_cameras(random);
    const std::vector<double> truth = {0, scenes::uniform(random, 0.004, 0.012),
                                       -scenes::uniform(random, 0.004, 0.012)};
    const auto solved = solve_rig(seen_by_clocks(rig, truth, 60, random));
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    EXPECT_FALSE(solved->rig.cameras[0].time_offset.has_value());
    for (std::size_t c = 1; c < 3; ++c) {
      const RigCamera& camera = solved->rig.cameras[c];
      ASSERT_TRUE(camera.time_offset.has_value()) << trial;
      const double e = (camera.time_offset->seconds - truth[c]) / camera.time_offset->sigma;
      offsets += e * e;
      worst = std::max(worst, std::abs(e));
      sigma = std::max(sigma, camera.time_offset->sigma);
      const SE3 at = rig.world_from_camera[0].inverse() * rig.world_from_camera[c];
      places += scenes::place_error(camera, at).square;
      ++cameras;
    }
  }
  std::cout << "mean square in sigmas: offsets " << offsets / cameras << ", places "
            << places / cameras << "; the worst offset " << worst << " sigmas, the largest sigma "
            << 1e3 * sigma << " ms\n";
  EXPECT_GT(offsets / cameras, 0.6);
  EXPECT_LT(offsets / cameras, 1.4);
  EXPECT_GT(places / cameras, 0.8);
  EXPECT_LT(places / cameras, 1.2);
  EXPECT_LT(worst, 4.5);
  EXPECT_LT(sigma, 1e-3);
}

// Nothing is told of clocks that agree, nor by boards that are held still.
TEST(RigClocks, AgreeWhereNothingSaysOtherwise) {
  const int trials = scenes::full_count() ? 400 : 25;
  int told = 0;
  double places = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(900 + static_cast<std::uint64_t>(trial));
    const SimulatedRig rig = three_cameras(random);
    const auto solved = solve_rig(seen_by_clocks(rig, {0, 0, 0}, 60, random));
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    for (std::size_t c = 1; c < 3; ++c) {
      const RigCamera& camera = solved->rig.cameras[c];
      told += camera.time_offset ? 1 : 0;
      const SE3 at = rig.world_from_camera[0].inverse() * rig.world_from_camera[c];
      places += scenes::place_error(camera, at).square;
    }
  }
  std::cout << told << " of " << 2 * trials << " told, places " << places / (2 * trials) << '\n';
  EXPECT_LE(told, trials / 50);
  EXPECT_LT(places / (2 * trials), 1.2);
  Random random(3);
  const SimulatedRig rig = three_cameras(random);
  const auto still = solve_rig(scenes::seen_by(rig, 30, 0.7, random));
  ASSERT_TRUE(still.has_value());
  for (const RigCamera& camera : still->rig.cameras) EXPECT_FALSE(camera.time_offset.has_value());
}

// Two pictures of one time may be nearer to others by their timestamps: they are paired by what the
// clocks should say. The rig's file keeps the offset, and a remark says it.
TEST(RigClocks, PairPicturesByWhatTheyShouldSay) {
  Random random(17);
  const SimulatedRig rig = three_cameras(random);
  RigOptions options;
  options.tolerance = 60'000'000;
  const auto solved = solve_rig(seen_by_clocks(rig, {0, 0.05, 0}, 90, random), options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  const auto& offset = solved->rig.cameras[1].time_offset;
  ASSERT_TRUE(offset.has_value());
  EXPECT_NEAR(offset->seconds, 0.05, 4.5 * offset->sigma);
  EXPECT_LT(offset->sigma, 1e-3);
  ASSERT_FALSE(solved->remarks.empty());
  EXPECT_NE(solved->remarks[0].find("The pictures of 'cam1' were taken "), std::string::npos);
  EXPECT_NE(solved->remarks[0].find(" later than their timestamps say"), std::string::npos);
  const auto text = print_rig(solved->rig);
  ASSERT_TRUE(text.has_value());
  const auto read = parse_rig(*text);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  ASSERT_TRUE(read->cameras[1].time_offset.has_value());
  EXPECT_DOUBLE_EQ(read->cameras[1].time_offset->seconds, offset->seconds);
  EXPECT_DOUBLE_EQ(read->cameras[1].time_offset->sigma, offset->sigma);
}

}  // namespace
}  // namespace calvin
