// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views and poses that leave open what a joint solve is asked for: each is refused with what to do.
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/strobl/joint_estimates.hpp"
#include "simulated_strobl.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::StroblRun;
using scenes::StroblScene;

class RefusedStrobl : public ::testing::TestWithParam<EyeSetup> {
 protected:
  RefusedStrobl() : scene_(scenes::random_strobl(GetParam(), 2, random_)) {
    options_.setup = GetParam();
  }

  // Of the run with these options, or of the run by its first camera alone.
  [[nodiscard]] std::string refusal(const StroblRun& run) const {
    const auto solved = solve_strobl(run.cameras, run.base_from_hand, options_);
    return solved ? "" : solved.error().message;
  }
  void expect(const StroblRun& run, const char* words) const {
    const std::string message = refusal(run);
    EXPECT_NE(message.find(words), std::string::npos) << words << ": " << message;
  }

  // The board where a hand would see it that was moved by these poses from where it began.
  [[nodiscard]] StroblRun moved_by(const std::vector<SE3>& motions) {
    const SE3 begin = {exp_so3({0.2, -0.1, 0.1}), {-0.1, -0.06, 0.5}};
    scenes::SimulatedRobot in_metres = scene_.robot;
    in_metres.scale = 1;
    const SE3 hand = scenes::hand_at(in_metres, begin);
    const SE3& mount = scene_.robot.mount_from_camera;
    const SE3& carrier = scene_.robot.carrier_from_board;
    std::vector<SE3> places;
    for (const SE3& motion : motions) {
      const SE3 now = hand * motion;
      places.push_back(GetParam() == EyeSetup::kInHand ? mount.inverse() * now.inverse() * carrier
                                                       : mount.inverse() * now * carrier);
    }
    return scenes::run_strobl_at(scene_, places, random_);
  }
  // What the camera alone has seen, of as many motions as show the board.
  [[nodiscard]] static StroblRun first_alone(StroblRun run) {
    run.cameras.resize(1);
    return run;
  }

  Random random_{31};
  StroblScene scene_;
  StroblOptions options_;
};
INSTANTIATE_TEST_SUITE_P(Setups, RefusedStrobl,
                         ::testing::Values(EyeSetup::kInHand, EyeSetup::kToHand),
                         [](const auto& test) {
                           return test.param == EyeSetup::kInHand ? "InHand" : "ToHand";
                         });

TEST_P(RefusedStrobl, NoCameraNamesAndCounts) {
  StroblRun run = scenes::random_strobl_run(scene_, 12, random_);
  EXPECT_EQ(refusal(run), "");
  StroblRun same = run;
  same.cameras[1].seen.calibration.camera = "cam0";
  expect(same, "are called 'cam0'");
  StroblRun short_one = run;
  short_one.cameras[1].pose_of_view.pop_back();
  expect(short_one, "give a pose for each view");
  StroblRun beyond = run;
  beyond.cameras[0].pose_of_view[0] = 12;
  expect(beyond, "give a pose for each view");
  StroblRun infinite = run;
  infinite.base_from_hand[3].translation[0] = std::numeric_limits<double>::infinity();
  expect(infinite, "Pose 4");
  StroblRun few = first_alone(run);
  few.cameras[0].seen.views.resize(2);
  few.cameras[0].pose_of_view.resize(2);
  expect(few, "3 are the least");
  run.cameras.clear();
  expect(run, "no camera");
}

TEST_P(RefusedStrobl, NoiseThatIsNone) {
  const StroblRun run = scenes::random_strobl_run(scene_, 12, random_);
  options_.place_sigma = -1;
  expect(run, "more than 0");
}

// Cameras that never see the board at one pose.
TEST_P(RefusedStrobl, CamerasThatNothingJoins) {
  StroblRun run = scenes::random_strobl_run(scene_, 24, random_);
  for (std::size_t c = 0; c < 2; ++c) {
    RobotCamera kept = run.cameras[c];
    kept.seen.views.clear();
    kept.pose_of_view.clear();
    for (std::size_t v = 0; v < run.cameras[c].pose_of_view.size(); ++v) {
      if (run.cameras[c].pose_of_view[v] % 2 != c) continue;
      kept.seen.views.push_back(run.cameras[c].seen.views[v]);
      kept.pose_of_view.push_back(run.cameras[c].pose_of_view[v]);
    }
    run.cameras[c] = std::move(kept);
  }
  expect(run, "seen no board at the same time");
}

// A hand that turns about a point of its own says nothing of lengths; with the pitch known it says
// where the camera is.
TEST_P(RefusedStrobl, HandThatTurnsAboutOnePoint) {
  // The point stays where the camera is near, so that the board stays in view.
  const SE3 point = {
      Eigen::Matrix3d::Identity(),
      GetParam() == EyeSetup::kInHand
          ? scene_.robot.mount_from_camera.translation
          : (scene_.robot.carrier_from_board * Eigen::Vector3d(0.1, 0.06, 0)).eval()};
  std::vector<SE3> motions;
  for (int i = 0; i < 120; ++i) {
    const Eigen::Vector3d turn(scenes::uniform(random_, -0.4, 0.4),
                               scenes::uniform(random_, -0.4, 0.4),
                               scenes::uniform(random_, -0.4, 0.4));
    motions.push_back(point * SE3{exp_so3(turn), {0, 0, 0}} * point.inverse());
  }
  const StroblRun run = first_alone(moved_by(motions));
  ASSERT_GT(run.cameras[0].seen.views.size(), 12U);
  expect(run, "turned about one point only");
  options_.pitch_known = true;
  scene_.robot.scale = 1;
  EXPECT_EQ(refusal(first_alone(moved_by(motions))), "");
}

TEST_P(RefusedStrobl, HandThatTurnsAboutOneAxis) {
  std::vector<SE3> motions;
  for (int i = 0; i < 120; ++i) {
    motions.push_back({exp_so3({0, 0, scenes::uniform(random_, -0.6, 0.6)}),
                       {scenes::uniform(random_, -0.1, 0.1), scenes::uniform(random_, -0.1, 0.1),
                        scenes::uniform(random_, -0.1, 0.1)}});
  }
  const StroblRun run = first_alone(moved_by(motions));
  ASSERT_GT(run.cameras[0].seen.views.size(), 8U);
  expect(run, "about one axis only");
}

// A board that stays parallel to the picture is one that the hand turns about its normal only. By
// what small turns do to it a hand tells a focal length all the same, as well as is said.
TEST_P(RefusedStrobl, FlatBoard) {
  for (const double tilt : {0.0, 0.02}) {
    std::vector<SE3> places;
    for (int i = 0; i < 25; ++i) {
      const auto draw = [&](double size) { return scenes::uniform(random_, -size, size); };
      places.push_back({exp_so3({draw(tilt), draw(tilt), draw(0.4)}),
                        {-0.1 + draw(0.03), -0.06 + draw(0.02), 0.5}});
    }
    const StroblRun run = first_alone(scenes::run_strobl_at(scene_, places, random_));
    ASSERT_GT(run.cameras[0].seen.views.size(), 12U);
    const auto solved = solve_strobl(run.cameras, run.base_from_hand, options_);
    if (tilt == 0) {
      expect(run, "about one axis only");
      continue;
    }
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    const Parameter& focal = solved->calibrations[0].parameters[0];
    EXPECT_GT(focal.sigma.value(), 0.003 * focal.value);
    EXPECT_NEAR(focal.value, scene_.cameras[0].fx(), 4.5 * focal.sigma.value());
  }
}

// What the covariance has to be for each of the last refusals.
TEST_P(RefusedStrobl, WhatIsNotDetermined) {
  StroblRun run = scenes::random_strobl_run(scene_, 20, random_);
  run.cameras.resize(1);
  rig::HandEyeFit fit;
  fit.mounted.cameras = {scene_.cameras[0]};
  rig::JointEstimates estimates;
  estimates.intrinsics = {{0, 4}};
  estimates.scale = {4, 1};
  estimates.aspect = {5, 1};
  const auto refused = [&](int row, double sigma) {
    estimates.covariance = 1e-8 * Eigen::MatrixXd::Identity(6, 6);
    estimates.covariance(row, row) = sigma * sigma;
    const Status checked = rig::check_determined(fit, estimates, {"cam0"});
    return checked ? "" : checked.error().message;
  };
  EXPECT_EQ(refused(4, 0.005), "");
  EXPECT_NE(refused(1, 200).find("focal length"), std::string::npos);
  EXPECT_NE(refused(2, 200).find("principal point"), std::string::npos);
  EXPECT_NE(refused(4, 0.02).find("hold its pitch"), std::string::npos);
  EXPECT_NE(refused(5, 0.01).find("hold its aspect"), std::string::npos);
}

// Boards that look the same turned by half: labels are those that the robot agrees with.
TEST_P(RefusedStrobl, ButNoBoardThatLooksTheSameTurned) {
  scene_.robot.board = parse_board("checkerboard:8x6:25mm").value();
  const StroblRun run = scenes::random_strobl_run(scene_, 20, random_);
  const auto solved = solve_strobl(run.cameras, run.base_from_hand, options_);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_LT(scenes::mount_error(solved->hand_eye, scene_.robot.mount_from_camera).largest, 4.5);
  EXPECT_LT(
      scenes::place_error(solved->rig->cameras[1], scene_.camera_from_first[1].inverse()).largest,
      4.5);
  EXPECT_NEAR(solved->hand_eye.aspect->value, scene_.aspect, 4.5 * solved->hand_eye.aspect->sigma);
}

}  // namespace
}  // namespace calvin
