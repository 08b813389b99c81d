// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Poses of a robot that cannot tell where its camera is are refused with what to do.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "simulated_robot.hpp"

namespace calvin {
namespace {

using scenes::kSetups;
using scenes::Random;
using scenes::RobotRun;
using scenes::SimulatedRobot;
using scenes::with;

std::string refusal(const RobotRun& run, const HandEyeOptions& options = {}) {
  const auto solved = solve_hand_eye(run.camera, run.base_from_hand, options);
  return solved ? "" : solved.error().message;
}

// Whether a refusal has these words.
void expect_refused(const RobotRun& run, const char* words, EyeSetup setup = EyeSetup::kInHand) {
  const std::string message = refusal(run, with(setup));
  EXPECT_NE(message.find(words), std::string::npos) << words << ": " << message;
}

class RefusedHandEye : public ::testing::TestWithParam<EyeSetup> {
 protected:
  RefusedHandEye() : robot_(scenes::random_robot(GetParam(), random_)) {
    run_ = scenes::random_run(robot_, 12, random_);
  }
  // Every pose of the robot as `change` makes it.
  template <typename Change>
  [[nodiscard]] RobotRun changed(const Change& change) const {
    RobotRun run = run_;
    for (Pose& pose : run.base_from_hand) pose = to_pose(change(to_se3(pose)));
    return run;
  }
  void expect(const RobotRun& run, const char* words) const {
    expect_refused(run, words, GetParam());
  }

  Random random_{10};
  SimulatedRobot robot_;
  RobotRun run_;
};
INSTANTIATE_TEST_SUITE_P(Setups, RefusedHandEye, ::testing::ValuesIn(kSetups),
                         [](const auto& test) {
                           return test.param == EyeSetup::kInHand ? "InHand" : "ToHand";
                         });

TEST_P(RefusedHandEye, OfTwoPosesOrNone) {
  for (const std::size_t left : {0U, 2U}) {
    RobotRun few = run_;
    few.camera.views.resize(left, few.camera.views.front());
    few.base_from_hand.resize(left);
    expect(few, "3 are the least");
  }
  RobotRun more = run_;
  more.base_from_hand.pop_back();
  expect(more, "12 views and 11 poses");
}

TEST_P(RefusedHandEye, OfPosesThatAreNone) {
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    RobotRun run = run_;
    run.base_from_hand[3].translation[2] = wrong;
    expect(run, "Pose 4");
    run = run_;
    run.base_from_hand[5].rotation[0] = wrong;
    expect(run, "Pose 6");
  }
  RobotRun run = run_;
  run.camera.views[2].board = parse_board("checkerboard:9x6:20mm").value();
  expect(run, "several boards");
}

// The camera at one orientation, or turned about its line of sight alone.
TEST_P(RefusedHandEye, WhereTheHandIsNotTurned) {
  for (const bool spins : {false, true}) {
    std::vector<SE3> poses;
    for (int i = 0; i < 12; ++i) {
      const Eigen::Vector3d at(-0.1 + 0.02 * std::sin(i), -0.06 + 0.02 * std::cos(3 * i),
                               0.5 + 0.01 * i);
      poses.push_back({exp_so3({0, 0, spins ? 0.1 * (i - 6) : 0.0}), at});
    }
    expect(scenes::run_at(robot_, poses, random_), spins ? "about one axis only" : "never turned");
    SimulatedRobot exact = robot_;
    exact.turn_sigma = exact.place_sigma = 0;
    expect(scenes::run_at(exact, poses, random_), spins ? "about one axis only" : "never turned");
  }
}

TEST_P(RefusedHandEye, OfInvertedPoses) {
  expect(changed([](const SE3& pose) { return pose.inverse(); }), "hand_from_base");
  expect_refused(run_, "the set-up is the other one",
                 GetParam() == EyeSetup::kInHand ? EyeSetup::kToHand : EyeSetup::kInHand);
}

TEST_P(RefusedHandEye, OfQuaternionsInAnotherOrder) {
  expect(changed([](const SE3& pose) {
           const Eigen::Quaterniond q(pose.rotation);
           const Eigen::Quaterniond read(q.z(), q.w(), q.x(), q.y());
           return SE3{read.toRotationMatrix(), pose.translation};
         }),
         "w first");
}

TEST_P(RefusedHandEye, OfLeftHandedFrames) {
  const Eigen::DiagonalMatrix<double, 3> mirror(1, -1, 1);
  expect(changed([&](const SE3& pose) {
           return SE3{mirror * pose.rotation * mirror, mirror * pose.translation};
         }),
         "left-handed");
}

TEST_P(RefusedHandEye, OfRotationsThatAreInverted) {
  expect(changed([](const SE3& pose) {
           return SE3{pose.rotation.transpose(), pose.translation};
         }),
         "rotations were inverted");
}

TEST_P(RefusedHandEye, OfPosesInAnotherOrder) {
  RobotRun run = run_;
  std::ranges::reverse(run.base_from_hand);
  expect(run, "reverse order");
  run = run_;
  std::rotate(run.base_from_hand.begin(), run.base_from_hand.end() - 1, run.base_from_hand.end());
  expect(run, "the next line");
  run = run_;
  std::rotate(run.base_from_hand.begin(), run.base_from_hand.begin() + 1, run.base_from_hand.end());
  expect(run, "the line before");
  run = run_;
  std::shuffle(run.base_from_hand.begin(), run.base_from_hand.end(), random_);
  expect(run, "base_from_hand");
}

TEST_P(RefusedHandEye, OfMillimetres) {
  expect(changed([](const SE3& pose) {
           return SE3{pose.rotation, 1000 * pose.translation};
         }),
         "times those of the board");
}

}  // namespace
}  // namespace calvin
