// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Robots with one camera or two of which all is known, and a board that is not as it is said to be.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/strobl/solve_strobl.hpp"
#include "simulated_robot.hpp"

namespace calvin::scenes {

struct StroblScene {
  std::vector<Camera> cameras;
  std::vector<SE3> camera_from_first;  // m of the robot
  // With `camera` the first one. `scale` is that of the board.
  SimulatedRobot robot;
  double aspect = 1;

  [[nodiscard]] Eigen::Vector3d on_sheet(const Eigen::Vector3d& printed) const {
    return robot.scale * Eigen::Vector3d(printed.x(), aspect * printed.y(), printed.z());
  }
};

inline StroblScene random_strobl(EyeSetup setup, std::size_t cameras, Random& random,
                                 const char* model = "brown5") {
  StroblScene scene{{}, {}, random_robot(setup, random)};
  for (std::size_t c = 0; c < cameras; ++c) {
    scene.cameras.push_back(random_camera(model, random));
    const auto draw = [&](double size) { return uniform(random, -size, size); };
    const Eigen::Vector3d turn(draw(0.05), 0.1 + draw(0.05), draw(0.05));
    const Eigen::Vector3d way(-0.08 + draw(0.03), draw(0.01), draw(0.01));
    scene.camera_from_first.push_back(c == 0 ? SE3() : SE3{exp_so3(turn), way});
  }
  scene.robot.camera = scene.cameras.front();
  scene.robot.scale = uniform(random, 0.95, 1.05);
  scene.aspect = uniform(random, 0.99, 1.01);
  return scene;
}

struct StroblRun {
  std::vector<RobotCamera> cameras;
  std::vector<Pose> base_from_hand;
  std::vector<SE3> first_from_board;  // as it was, m of the robot
};

// What a camera sees of the sheet, with noise; nothing where a corner is outside the image.
inline std::vector<View> observe_sheet(const StroblScene& scene, const Camera& camera,
                                       const SE3& camera_from_board, Random& random) {
  View view = {{}, scene.robot.board};
  std::normal_distribution<double> noise(0, scene.robot.noise);
  view.observation.board = scene.robot.board.text();
  view.observation.image_size = camera.image_size();
  view.observation.ids = scene.robot.board.ids();
  for (const Eigen::Vector3d& printed : scene.robot.board.points()) {
    const auto at = camera.project(camera_from_board * scene.on_sheet(printed));
    if (!at || at->u < 1 || at->v < 1 || at->u > camera.image_size().width - 2 ||
        at->v > camera.image_size().height - 2) {
      return {};
    }
    const double u = at->u + noise(random);
    view.observation.uv.push_back({u, at->v + noise(random)});
    view.observation.sigma.push_back(scene.robot.noise);
  }
  return {view};
}

// At these places of the board before the first camera, m of the robot.
inline StroblRun run_strobl_at(const StroblScene& scene, std::vector<SE3> first_from_board,
                               Random& random) {
  StroblRun run;
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    RobotCamera& camera = run.cameras.emplace_back();
    camera.seen.calibration = scene.cameras[c].to_calibration();
    camera.seen.calibration.camera = "cam" + std::to_string(c);
  }
  SimulatedRobot in_metres = scene.robot;
  in_metres.scale = 1;
  std::normal_distribution<double> noise(0, 1);
  const auto draw = [&](double sigma) {
    const double x = sigma * noise(random);
    const double y = sigma * noise(random);
    return Eigen::Vector3d(x, y, sigma * noise(random));
  };
  for (const SE3& pose : first_from_board) {
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
      RobotCamera& camera = run.cameras[c];
      for (View& view :
           observe_sheet(scene, scene.cameras[c], scene.camera_from_first[c] * pose, random)) {
        view.observation.timestamp = 1'000'000'000 * (run.base_from_hand.size() + 1);
        name_at_random(view, random);
        camera.seen.views.push_back(std::move(view));
        camera.pose_of_view.push_back(run.base_from_hand.size());
      }
    }
    SE3 hand = hand_at(in_metres, pose);
    hand.rotation = exp_so3(draw(scene.robot.turn_sigma)) * hand.rotation;
    hand.translation += draw(scene.robot.place_sigma);
    run.base_from_hand.push_back(to_pose(hand));
  }
  run.first_from_board = std::move(first_from_board);
  return run;
}

// The board all over the picture of one camera after the other.
inline StroblRun random_strobl_run(const StroblScene& scene, int poses, Random& random) {
  std::vector<SE3> places;
  for (int i = 0; i < poses; ++i) {
    const std::size_t c = static_cast<std::size_t>(i) % scene.cameras.size();
    SE3 pose = random_pose(scene.cameras[c], scene.robot.board, random, uniform(random, 0, 0.8));
    pose.translation *= scene.robot.scale;
    places.push_back(scene.camera_from_first[c].inverse() * pose);
  }
  return run_strobl_at(scene, std::move(places), random);
}

// Found less true, in the order of StroblSolution::names.
inline Eigen::VectorXd strobl_errors(const StroblSolution& found, const StroblScene& truth) {
  std::vector<double> errors;
  const auto add_pose = [&](const Pose& pose, const SE3& true_pose) {
    const SE3 is = to_se3(pose);
    const Eigen::Vector3d turn = log_so3(is.rotation * true_pose.rotation.transpose());
    const Eigen::Vector3d place = is.translation - true_pose.translation;
    errors.insert(errors.end(), turn.begin(), turn.end());
    errors.insert(errors.end(), place.begin(), place.end());
  };
  for (std::size_t c = 0; c < truth.cameras.size(); ++c) {
    for (std::size_t i = 0; i < truth.cameras[c].parameters().size(); ++i) {
      errors.push_back(found.calibrations[c].parameters[i].value -
                       truth.cameras[c].parameters()[i]);
    }
  }
  for (std::size_t c = 1; c < truth.cameras.size(); ++c) {
    add_pose(found.rig->cameras[c].rig_from_camera, truth.camera_from_first[c].inverse());
  }
  add_pose(found.hand_eye.mount_from_camera, truth.robot.mount_from_camera);
  add_pose(found.hand_eye.carrier_from_board, truth.robot.carrier_from_board);
  if (found.hand_eye.scale) errors.push_back(found.hand_eye.scale->value - truth.robot.scale);
  if (found.hand_eye.aspect) errors.push_back(found.hand_eye.aspect->value - truth.aspect);
  return Eigen::Map<Eigen::VectorXd>(errors.data(), static_cast<Eigen::Index>(errors.size()));
}

inline Eigen::MatrixXd strobl_covariance(const StroblSolution& found) {
  const auto n = static_cast<Eigen::Index>(found.names.size());
  return Eigen::Map<const Eigen::MatrixXd>(found.covariance.data(), n, n);
}

// e^T C^-1 e over the number of estimated parameters.
inline double strobl_square(const StroblSolution& found, const StroblScene& truth) {
  const Eigen::VectorXd e = strobl_errors(found, truth);
  const Eigen::MatrixXd c = strobl_covariance(found);
  const Eigen::VectorXd sigma = c.diagonal().cwiseSqrt();
  const Eigen::VectorXd scaled = e.cwiseQuotient(sigma);
  const Eigen::VectorXd inverse = sigma.cwiseInverse();
  const Eigen::MatrixXd correlation = inverse.asDiagonal() * c * inverse.asDiagonal();
  return scaled.dot(solve_symmetric(correlation, scaled).col(0)) / static_cast<double>(e.size());
}

// The cameras as calvin-solve finds them by the same views; false where it refuses one.
inline bool solve_cameras(StroblRun& run, bool aspect) {
  for (RobotCamera& camera : run.cameras) {
    SolveOptions options;
    options.model = camera.seen.calibration.model;
    options.checks = false;
    options.warp = false;
    options.aspect = aspect;
    auto solved = solve(camera.seen.views, camera.seen.calibration.image_size, options);
    if (!solved) return false;
    solved->calibration.camera = camera.seen.calibration.camera;
    camera.seen.calibration = solved->calibration;
  }
  return true;
}

}  // namespace calvin::scenes
