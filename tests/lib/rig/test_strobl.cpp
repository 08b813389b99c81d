// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Robots with one camera or two and a board of unknown pitch and aspect: all of it is found in one
// solve, as well as is said, from wherever it starts, and no worse than step by step.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/hand_eye.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "calvin/rig/strobl/joint_estimates.hpp"
#include "calvin/rig/strobl/joint_loops.hpp"
#include "simulated_strobl.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::StroblRun;
using scenes::StroblScene;

constexpr EyeSetup kSetups[] = {EyeSetup::kInHand, EyeSetup::kToHand};
constexpr int kPoses = 25;

StroblOptions with(EyeSetup setup) {
  StroblOptions options;
  options.setup = setup;
  return options;
}

// The least squares alone, from the truth. Absent where it finds nothing.
std::optional<rig::HandEyeFit> fit_from_truth(const StroblScene& scene, const StroblRun& run) {
  std::vector<RigCameraViews> seen;
  std::vector<std::string> names;
  for (std::size_t c = 0; c < run.cameras.size(); ++c) {
    seen.push_back(run.cameras[c].seen);
    seen.back().calibration = scene.cameras[c].to_calibration();
    seen.back().calibration.camera = names.emplace_back("cam" + std::to_string(c));
  }
  const auto views = rig::board_views(seen, scene.cameras).value();
  std::vector<std::size_t> pose_of_view;
  for (const rig::BoardView& view : views) {
    pose_of_view.push_back(run.cameras[view.of.camera].pose_of_view[view.of.view]);
  }
  std::vector<SE3> hands;
  for (const Pose& pose : run.base_from_hand) hands.push_back(to_se3(pose));
  auto loops =
      rig::joint_loops(views, pose_of_view, hands, scene.cameras, names, scene.robot.setup, true);
  if (!loops) return std::nullopt;
  // In lengths of the board.
  const auto on_board = [&](SE3 pose) {
    pose.translation /= scene.robot.scale;
    return pose;
  };
  for (std::size_t v = 0; v < loops->loops.size(); ++v) {
    loops->loops[v].camera_from_board = on_board(run.first_from_board[loops->poses[v]]);
  }
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    loops->mounted.camera_from_first[c] = on_board(scene.camera_from_first[c]);
  }
  rig::HandEyeTask task;
  task.setup = scene.robot.setup;
  task.free_scale = task.free_cameras = task.free_aspect = true;
  const auto fit = rig::fit_hand_eye(
      loops->loops,
      {scene.robot.mount_from_camera, scene.robot.carrier_from_board, scene.robot.scale},
      {scene.robot.turn_sigma, scene.robot.place_sigma}, loops->mounted, seen, task, {});
  return fit ? std::optional(*fit) : std::nullopt;
}

// The largest difference between a solution and a fit, in sigmas.
double difference(const StroblSolution& found, const rig::HandEyeFit& fit) {
  const Eigen::MatrixXd c = scenes::strobl_covariance(found);
  double most = 0;
  Eigen::Index row = 0;
  const auto compare = [&](double one, double other) {
    most = std::max(most, std::abs(one - other) / std::sqrt(c(row, row)));
    ++row;
  };
  for (std::size_t k = 0; k < fit.mounted.cameras.size(); ++k) {
    const auto& parameters = fit.mounted.cameras[k].parameters();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      compare(found.calibrations[k].parameters[i].value, parameters[i]);
    }
  }
  const auto n = static_cast<Eigen::Index>(found.names.size());
  row = n - 11;  // mount.tx: behind the pose of the mount are that of the carrier, scale and aspect
  for (int k = 0; k < 3; ++k) {
    compare(found.hand_eye.mount_from_camera.translation[static_cast<std::size_t>(k)],
            fit.places.mount_from_camera.translation[k]);
  }
  row = n - 2;
  compare(found.hand_eye.scale->value, fit.places.scale);
  compare(found.hand_eye.aspect->value, fit.aspect);
  return most;
}

class Strobl : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Cameras, Strobl, ::testing::Values(1, 2),
                         [](const auto& test) { return test.param == 1 ? "One" : "Two"; });

TEST_P(Strobl, IsAsWellKnownAsItSays) {
  const int trials = scenes::full_count() ? 250 : 24;
  double squares = 0;
  int elsewhere = 0;
  int rejected = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(100 + static_cast<std::uint64_t>(trial));
    const StroblScene scene = scenes::random_strobl(kSetups[trial % 2], GetParam(), random);
    StroblRun run = scenes::random_strobl_run(scene, kPoses, random);
    ASSERT_TRUE(scenes::solve_cameras(run, false)) << trial;
    const auto solved = solve_strobl(run.cameras, run.base_from_hand, with(scene.robot.setup));
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    squares += scenes::strobl_square(*solved, scene) / trials;
    rejected += static_cast<int>(solved->loops.size()) - solved->hand_eye.poses;
    const auto truth = fit_from_truth(scene, run);
    ASSERT_TRUE(truth.has_value()) << trial;
    if (difference(*solved, *truth) > 0.03) ++elsewhere;
  }
  std::cout << trials << " robots with " << GetParam()
            << " camera(s): mean of e^T C^-1 e / dof = " << squares << "; " << elsewhere
            << " at another optimum than from the truth; " << rejected << " poses left out\n";
  EXPECT_NEAR(squares, 1, 0.2);
  EXPECT_LE(elsewhere, trials / 100);
  EXPECT_LE(rejected, 1 + trials / 50);
}

}  // namespace
}  // namespace calvin
