// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Robots of which it is known where camera and board are: what the camera sees, and the poses that
// the robot tells, with noise.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "calvin/rig/hand_eye.hpp"
#include "simulated_rig.hpp"

namespace calvin::scenes {

struct SimulatedRobot {
  Camera camera;
  EyeSetup setup = EyeSetup::kInHand;
  Board board = kBoard;
  SE3 mount_from_camera = {};
  SE3 carrier_from_board = {};
  double turn_sigma = 1e-3;   // rad, of the poses that it tells
  double place_sigma = 5e-4;  // m
  double noise = 0.1;         // px
  double scale = 1;           // metres of the robot in a metre of the board
};

inline SE3 random_place(double reach, Random& random) {
  const auto draw = [&] { return uniform(random, -1, 1); };
  const Eigen::Vector3d axis(draw(), draw(), draw());
  const double angle = uniform(random, 0, std::numbers::pi);
  return {exp_so3(axis.normalized() * angle), reach * Eigen::Vector3d(draw(), draw(), draw())};
}

inline SimulatedRobot random_robot(EyeSetup setup, Random& random) {
  SimulatedRobot robot{random_camera("brown5", random), setup};
  const bool on_hand = setup == EyeSetup::kInHand;
  robot.mount_from_camera = random_place(on_hand ? 0.1 : 1, random);
  robot.carrier_from_board = random_place(on_hand ? 1 : 0.2, random);
  robot.turn_sigma = uniform(random, 0.3e-3, 3e-3);
  robot.place_sigma = uniform(random, 0.1e-3, 1e-3);
  return robot;
}

inline SE3 hand_at(const SimulatedRobot& robot, const SE3& camera_from_board) {
  const SE3 seen = {camera_from_board.rotation, robot.scale * camera_from_board.translation};
  const SE3 mount_from_carrier =
      robot.mount_from_camera * seen * robot.carrier_from_board.inverse();
  return robot.setup == EyeSetup::kInHand ? mount_from_carrier.inverse() : mount_from_carrier;
}

struct RobotRun {
  RigCameraViews camera;
  std::vector<Pose> base_from_hand;
};

// At poses of the board before the camera. A board that looks the same turned is named either way.
inline RobotRun run_at(const SimulatedRobot& robot, const std::vector<SE3>& camera_from_board,
                       Random& random) {
  RobotRun run;
  run.camera.calibration = robot.camera.to_calibration();
  run.camera.calibration.camera = "cam0";
  std::normal_distribution<double> noise(0, 1);
  const auto draw = [&](double sigma) {
    return Eigen::Vector3d(sigma * noise(random), sigma * noise(random), sigma * noise(random));
  };
  for (const SE3& pose : camera_from_board) {
    View view = observe(robot.camera, robot.board, pose, robot.noise, random);
    view.observation.timestamp = 1'000'000'000 * (run.camera.views.size() + 1);
    name_at_random(view, random);
    run.camera.views.push_back(std::move(view));
    SE3 hand = hand_at(robot, pose);
    hand.rotation = exp_so3(draw(robot.turn_sigma)) * hand.rotation;
    hand.translation += draw(robot.place_sigma);
    run.base_from_hand.push_back(to_pose(hand));
  }
  return run;
}

inline RobotRun random_run(const SimulatedRobot& robot, int poses, Random& random) {
  return run_at(robot, random_poses(robot.camera, robot.board, random, poses, 0.8), random);
}

// As place_error() of a rig.
inline PlaceError mount_error(const HandEye& found, const SE3& truth) {
  RigCamera camera;
  camera.rig_from_camera = found.mount_from_camera;
  camera.covariance = found.mount_covariance;
  return place_error(camera, truth);
}
inline PlaceError carrier_error(const HandEye& found, const SE3& truth) {
  RigCamera board;
  board.rig_from_camera = found.carrier_from_board;
  board.covariance = found.carrier_covariance;
  return place_error(board, truth);
}

inline constexpr EyeSetup kSetups[] = {EyeSetup::kInHand, EyeSetup::kToHand};

inline HandEyeOptions with(EyeSetup setup) {
  HandEyeOptions options;
  options.setup = setup;
  return options;
}

}  // namespace calvin::scenes
