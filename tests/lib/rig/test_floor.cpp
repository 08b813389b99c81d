// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras, each by itself before a board that lies still: their places are found, and what is said
// of the errors is so.
#include <algorithm>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::place_error;
using scenes::Random;
using scenes::SimulatedRig;

// Each camera by itself before a board that lies still, at a time of its own.
TEST(Floor, GivesEveryCameraItsPlaceBeforeTheBoard) {
  const int trials = scenes::full_count() ? 500 : 60;
  double squares = 0;
  int cameras = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(7000 + static_cast<std::uint64_t>(trial));
    SimulatedRig rig = scenes::ring_rig(4, random);
    rig.reach.setZero();
    // Flat on the floor, seen from above: z of the world points down.
    const BoardArea extent = rig.board.extent();
    const SE3 world_from_board = {Eigen::Matrix3d::Identity(),
                                  {-extent.width() / 2, -extent.height() / 2, 0}};
    std::vector<RigCameraViews> seen(4);
    for (std::size_t c = 0; c < 4; ++c) {
      seen[c].calibration = rig.cameras[c].to_calibration();
      seen[c].calibration.camera = "cam" + std::to_string(c);
      const SE3 pose = rig.world_from_camera[c].inverse() * world_from_board;
      for (std::size_t n = 0; n <= c; ++n) {
        View view = scenes::observe(rig.cameras[c], rig.board, pose, rig.noise, random);
        view.observation.timestamp = (1 + 10 * c + n) * 1'000'000'000;
        seen[c].views.push_back(std::move(view));
      }
    }
    const auto solved = solve_rig(seen, {RigMode::kFloor, 0});
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_EQ(solved->rig.world, kBoardWorld);
    for (std::size_t c = 0; c < 4; ++c) {
      const SE3 truth = world_from_board.inverse() * rig.world_from_camera[c];
      squares += place_error(solved->rig.cameras[c], truth).square;
      ++cameras;
    }
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / cameras << '\n';
  EXPECT_NEAR(squares / cameras, 1, 0.15);
}

TEST(Floor, IsRefusedWhereTheBoardMovesOrLooksTheSameTurned) {
  Random random(8);
  SimulatedRig rig = scenes::stereo_rig(random);
  const auto moved = solve_rig(scenes::seen_by(rig, 10, 0.5, random), {RigMode::kFloor, 0});
  ASSERT_FALSE(moved.has_value());
  EXPECT_NE(moved.error().message.find("several places"), std::string::npos);
  rig.board = parse_board("checkerboard:8x6:25mm").value();
  const auto turned = solve_rig(scenes::seen_by(rig, 10, 0.5, random), {RigMode::kFloor, 0});
  ASSERT_FALSE(turned.has_value());
  EXPECT_NE(turned.error().message.find("puzzle:14x9:20mm"), std::string::npos);
}

// One picture of one board by one camera: what it says of its error is so, and where that is large
// because the board is seen head-on and small, so is what it tells.
TEST(OneCamera, StandsBeforeAFloorBoardAsWellAsItSays) {
  const int trials = scenes::full_count() ? 2000 : 200;
  for (const bool is_tilted : {true, false}) {
    double squares = 0;
    int warned = 0;
    for (int trial = 0; trial < trials; ++trial) {
      Random random(5000 + static_cast<std::uint64_t>(trial));
      const Camera camera = scenes::random_camera("brown5", random);
      const double tilt = is_tilted ? 0.6 : scenes::uniform(random, 0, 0.03);
      const BoardArea extent = scenes::kBoard.extent();
      const Eigen::Vector3d middle(extent.width() / 2, extent.height() / 2, 0);
      const Eigen::Matrix3d turn = exp_so3({tilt, 0, 0});
      const SE3 pose = {turn, Eigen::Vector3d(0, 0, is_tilted ? 0.5 : 4) - turn * middle};
      RigCameraViews seen;
      seen.calibration = camera.to_calibration();
      seen.calibration.camera = "one";
      seen.views.push_back(scenes::observe(camera, scenes::kBoard, pose, 0.1, random));
      const auto solved = solve_rig({seen}, {RigMode::kFloor, 0});
      ASSERT_TRUE(solved.has_value()) << solved.error().message;
      EXPECT_EQ(solved->rig.world, kBoardWorld);
      if (is_tilted) squares += place_error(solved->rig.cameras[0], pose.inverse()).square;
      const auto is_warning = [](const std::string& remark) {
        return remark.find("is known to") != std::string::npos;
      };
      warned += std::ranges::any_of(solved->remarks, is_warning) ? 1 : 0;
    }
    if (is_tilted) {
      std::cout << "mean of e^T C^-1 e / 6 = " << squares / trials << '\n';
      EXPECT_NEAR(squares / trials, 1, scenes::full_count() ? 0.1 : 0.2);
      EXPECT_EQ(warned, 0);
    } else {
      EXPECT_GT(warned, 0.95 * trials);
    }
  }
}

}  // namespace
}  // namespace calvin
