// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Robots of which it is known where the camera is: it is found, what is said of the errors is so.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/hand_eye/loop.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "simulated_robot.hpp"

namespace calvin {
namespace {

using scenes::kSetups;
using scenes::Random;
using scenes::RobotRun;
using scenes::SimulatedRobot;
using scenes::with;

TEST(HandEyeLoop, HasTheDerivativesOfItsError) {
  Random random(1);
  for (const EyeSetup setup : kSetups) {
    const SimulatedRobot robot = scenes::random_robot(setup, random);
    const rig::HandEyePlaces places = {robot.mount_from_camera, robot.carrier_from_board, 1.1};
    const SE3 board = scenes::random_poses(robot.camera, robot.board, random, 1).front();
    SE3 hand = rig::expected_hand(places, setup, board);
    EXPECT_LT(rig::hand_error(rig::expected_hand(places, setup, board), hand).norm(), 1e-12);
    hand.rotation = exp_so3({0.02, -0.01, 0.03}) * hand.rotation;
    hand.translation += Eigen::Vector3d(0.01, 0.02, -0.03);
    const rig::LoopRows rows = rig::loop_rows(places, setup, board, hand);
    const auto error = [&](const rig::HandEyePlaces& p, const SE3& seen) {
      return rig::hand_error(rig::expected_hand(p, setup, seen), hand);
    };
    constexpr double kStep = 1e-6;
    for (int k = 0; k < rig::kPlaceColumns; ++k) {
      double step[rig::kPlaceColumns] = {};
      step[k] = kStep;
      const auto ahead = error(rig::moved(places, step), board);
      step[k] = -kStep;
      const auto behind = error(rig::moved(places, step), board);
      EXPECT_LT(((ahead - behind) / (2 * kStep) - rows.by_places.col(k)).norm(), 1e-6) << k;
    }
    for (int k = 0; k < 6; ++k) {
      double step[6] = {};
      step[k] = kStep;
      const auto ahead = error(places, retract(board, step));
      step[k] = -kStep;
      const auto behind = error(places, retract(board, step));
      EXPECT_LT(((ahead - behind) / (2 * kStep) - rows.by_board.col(k)).norm(), 1e-6) << k;
    }
  }
}

// Sums of what is predicted and of what is true.
struct Comparison {
  double squares = 0;            // e^T C^-1 e / 6
  double predicted[2] = {0, 0};  // of turn and place, squared
  double actual[2] = {0, 0};
  int count = 0;

  void add(const scenes::PlaceError& error, const std::vector<double>& covariance) {
    squares += error.square;
    for (std::size_t k = 0; k < 6; ++k) predicted[k / 3] += covariance[7 * k];
    actual[0] += error.turn * error.turn;
    actual[1] += error.place * error.place;
    ++count;
  }
  [[nodiscard]] double ratio(std::size_t which) const {
    return std::sqrt(predicted[which] / actual[which]);
  }
};

TEST(HandEye, IsAsWellKnownAsItSays) {
  const int trials = scenes::full_count() ? 1000 : 120;
  for (const EyeSetup setup : kSetups) {
    Comparison mount;
    Comparison carrier;
    double noise[2] = {0, 0};
    int rejected = 0;
    for (int trial = 0; trial < trials; ++trial) {
      Random random(1000 + static_cast<std::uint64_t>(trial));
      const SimulatedRobot robot = scenes::random_robot(setup, random);
      const RobotRun run = scenes::random_run(robot, 25, random);
      const auto solved = solve_hand_eye(run.camera, run.base_from_hand, with(setup));
      ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
      const HandEye& found = solved->result;
      mount.add(scenes::mount_error(found, robot.mount_from_camera), found.mount_covariance);
      carrier.add(scenes::carrier_error(found, robot.carrier_from_board), found.carrier_covariance);
      noise[0] += found.robot_turn_sigma / robot.turn_sigma / trials;
      noise[1] += found.robot_place_sigma / robot.place_sigma / trials;
      rejected += 25 - found.poses;
    }
    std::cout << (setup == EyeSetup::kInHand ? "eye-in-hand" : "eye-to-hand")
              << ": predicted over true " << mount.ratio(0) << " (turn), " << mount.ratio(1)
              << " (place); of the board " << carrier.ratio(0) << ", " << carrier.ratio(1)
              << "; mean of e^T C^-1 e / 6 = " << mount.squares / mount.count << ", "
              << carrier.squares / carrier.count << "; noise found over true " << noise[0] << ", "
              << noise[1] << "; " << rejected << " poses left out\n";
    // The mean over 120 robots has a sigma of 0.08 by itself.
    const double margin = scenes::full_count() ? 0.1 : 0.35;
    for (const Comparison* one : {&mount, &carrier}) {
      EXPECT_NEAR(one->ratio(0), 1, margin);
      EXPECT_NEAR(one->ratio(1), 1, margin);
      EXPECT_NEAR(one->squares / one->count, 1, margin);
    }
    EXPECT_NEAR(noise[0], 1, 0.05);
    EXPECT_NEAR(noise[1], 1, 0.05);
    EXPECT_LE(rejected, trials / 100);
  }
}

// Boards that look the same after a turn, which every view names as it likes.
TEST(HandEye, IsNeverTurnedByASymmetricBoard) {
  const int trials = scenes::full_count() ? 300 : 15;
  int refused = 0;
  int all = 0;
  for (const char* text : {"checkerboard:8x6:25mm", "checkerboard:6x6:25mm", "circles:7x5:25mm"}) {
    for (int trial = 0; trial < trials; ++trial) {
      Random random(2000 + static_cast<std::uint64_t>(trial));
      const EyeSetup setup = kSetups[trial % 2];
      SimulatedRobot robot = scenes::random_robot(setup, random);
      robot.board = parse_board(text).value();
      const RobotRun run = scenes::random_run(robot, 12, random);
      const auto solved = solve_hand_eye(run.camera, run.base_from_hand, with(setup));
      ++all;
      if (!solved) {
        ++refused;
        continue;
      }
      EXPECT_LT(scenes::mount_error(solved->result, robot.mount_from_camera).largest, 7)
          << text << trial;
    }
  }
  std::cout << refused << " of " << all << " refused\n";
  EXPECT_LE(refused, all / 50);
}

// With a board that is small and far away the wrong tilts of single views are not taken.
TEST(HandEye, IsNotTiltedByAFlatBoard) {
  const int trials = scenes::full_count() ? 300 : 20;
  int refused = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(3000 + static_cast<std::uint64_t>(trial));
    SimulatedRobot robot = scenes::random_robot(EyeSetup::kInHand, random);
    robot.board = parse_board("checkerboard:5x4:15mm").value();
    robot.noise = 0.2;
    std::vector<SE3> poses = scenes::random_poses(robot.camera, robot.board, random, 20, 0.25);
    for (SE3& pose : poses) pose.translation *= 2;
    const RobotRun run = scenes::run_at(robot, poses, random);
    const auto solved = solve_hand_eye(run.camera, run.base_from_hand);
    if (!solved) {
      ++refused;
      continue;
    }
    EXPECT_LT(scenes::mount_error(solved->result, robot.mount_from_camera).largest, 7) << trial;
  }
  std::cout << refused << " of " << trials << " refused\n";
  EXPECT_LE(refused, trials / 20);
}

TEST(HandEye, KnowsThatIntrinsicsAreNotExact) {
  const int trials = scenes::full_count() ? 1000 : 60;
  double squares = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(4000 + static_cast<std::uint64_t>(trial));
    SimulatedRobot robot = scenes::random_robot(EyeSetup::kInHand, random);
    robot.turn_sigma = 3e-4;
    robot.place_sigma = 1e-4;
    RobotRun run = scenes::random_run(robot, 20, random);
    std::normal_distribution<double> noise(0, 1);
    // Both focal lengths err together.
    const double focal = noise(random);
    const double sigmas[] = {1.5, 1.5, 2, 2};
    run.camera.calibration.covariance.assign(16, 0.0);
    for (std::size_t i = 0; i < 4; ++i) {
      Parameter& p = run.camera.calibration.parameters[i];
      p.sigma = sigmas[i];
      p.value += sigmas[i] * (i < 2 ? focal : noise(random));
      run.camera.calibration.covariance[5 * i] = sigmas[i] * sigmas[i];
    }
    run.camera.calibration.covariance[1] = run.camera.calibration.covariance[4] =
        sigmas[0] * sigmas[1];
    const auto solved = solve_hand_eye(run.camera, run.base_from_hand);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    squares += scenes::mount_error(solved->result, robot.mount_from_camera).square;
  }
  std::cout << "mean of e^T C^-1 e / 6 = " << squares / trials << '\n';
  EXPECT_NEAR(squares / trials, 1, 0.35);
}

// The board's squares are 24.7 mm where 25 was given; and a board of the right size.
TEST(HandEye, SaysWhereLengthsOfBoardAndRobotDiffer) {
  const int trials = scenes::full_count() ? 300 : 60;
  double square = 0;
  int wrong = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(5000 + static_cast<std::uint64_t>(trial));
    SimulatedRobot robot = scenes::random_robot(kSetups[trial % 2], random);
    robot.scale = trial % 4 < 2 ? 24.7 / 25 : 1;
    const RobotRun run = scenes::random_run(robot, 25, random);
    HandEyeOptions options = with(robot.setup);
    const auto solved = solve_hand_eye(run.camera, run.base_from_hand, options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    ASSERT_TRUE(solved->result.scale.has_value());
    const LengthRatio& scale = *solved->result.scale;
    square += std::pow((scale.value - robot.scale) / scale.sigma, 2);
    const bool said = std::ranges::any_of(solved->result.remarks, [](const std::string& remark) {
      return remark.find("pitch of the board measures 24.") != std::string::npos;
    });
    if (said != (robot.scale != 1)) ++wrong;
    // With the scale free the places are the robot's.
    options.free_scale = true;
    const auto free = solve_hand_eye(run.camera, run.base_from_hand, options);
    ASSERT_TRUE(free.has_value()) << free.error().message;
    EXPECT_LT(scenes::mount_error(free->result, robot.mount_from_camera).largest, 6) << trial;
  }
  std::cout << "mean square of (scale - true) / sigma = " << square / trials << "; " << wrong
            << " of " << trials << " said wrongly\n";
  EXPECT_NEAR(square / trials, 1, scenes::full_count() ? 0.25 : 0.7);
  EXPECT_LE(wrong, 1 + trials / 50);
}

TEST(HandEye, BelievesTheNoiseThatIsGiven) {
  Random random(6);
  const SimulatedRobot robot = scenes::random_robot(EyeSetup::kInHand, random);
  const RobotRun run = scenes::random_run(robot, 25, random);
  HandEyeOptions options;
  options.turn_sigma = robot.turn_sigma;
  options.place_sigma = robot.place_sigma;
  const auto solved = solve_hand_eye(run.camera, run.base_from_hand, options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->result.robot_turn_sigma, robot.turn_sigma);
  EXPECT_LT(scenes::mount_error(solved->result, robot.mount_from_camera).largest, 4);
  options.turn_sigma = robot.turn_sigma / 5;
  const auto better = solve_hand_eye(run.camera, run.base_from_hand, options);
  ASSERT_TRUE(better.has_value()) << better.error().message;
  ASSERT_FALSE(better->result.remarks.empty());
  EXPECT_NE(better->result.remarks.front().find("worse than was given"), std::string::npos);
  options.turn_sigma = -1;
  EXPECT_FALSE(solve_hand_eye(run.camera, run.base_from_hand, options).has_value());
}

TEST(HandEye, LeavesOutAPoseThatContradictsTheOthers) {
  Random random(7);
  const SimulatedRobot robot = scenes::random_robot(EyeSetup::kInHand, random);
  RobotRun run = scenes::random_run(robot, 20, random);
  run.base_from_hand[4].translation[1] += 0.05;
  const auto solved = solve_hand_eye(run.camera, run.base_from_hand);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->result.poses, 19);
  ASSERT_EQ(solved->loops.size(), 20U);
  EXPECT_FALSE(solved->loops[4].used);
  EXPECT_LT(scenes::mount_error(solved->result, robot.mount_from_camera).largest, 4);
}

TEST(HandEye, IsTheSameAtEveryRun) {
  Random random(8);
  const SimulatedRobot robot = scenes::random_robot(EyeSetup::kToHand, random);
  const RobotRun run = scenes::random_run(robot, 12, random);
  const auto first = solve_hand_eye(run.camera, run.base_from_hand, with(robot.setup));
  const auto second = solve_hand_eye(run.camera, run.base_from_hand, with(robot.setup));
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->result.mount_from_camera.rotation, second->result.mount_from_camera.rotation);
  EXPECT_EQ(first->result.mount_from_camera.translation,
            second->result.mount_from_camera.translation);
  EXPECT_EQ(first->result.mount_covariance, second->result.mount_covariance);
}

// Three poses are enough for an answer, exact poses for an exact one.
TEST(HandEye, IsFoundByThreeExactPoses) {
  for (int trial = 0; trial < 20; ++trial) {
    Random random(9000 + static_cast<std::uint64_t>(trial));
    SimulatedRobot robot = scenes::random_robot(kSetups[trial % 2], random);
    robot.turn_sigma = robot.place_sigma = robot.noise = 0;
    const RobotRun run = scenes::random_run(robot, 3, random);
    const auto solved = solve_hand_eye(run.camera, run.base_from_hand, with(robot.setup));
    ASSERT_TRUE(solved.has_value()) << trial << solved.error().message;
    const auto error = scenes::mount_error(solved->result, robot.mount_from_camera);
    EXPECT_LT(error.turn, 1e-6) << trial;
    EXPECT_LT(error.place, 1e-6) << trial;
  }
}

}  // namespace
}  // namespace calvin
