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
  const int trials = scenes::full_count() ? 2000 : 16;
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

// Focal lengths that are a tenth off, and lenses without distortion.
TEST_P(Strobl, BeginsFarAway) {
  const int trials = scenes::full_count() ? 200 : 6;
  int elsewhere = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(4000 + static_cast<std::uint64_t>(trial));
    const StroblScene scene = scenes::random_strobl(kSetups[trial % 2], GetParam(), random);
    StroblRun run = scenes::random_strobl_run(scene, kPoses, random);
    for (RobotCamera& camera : run.cameras) {
      std::vector<Parameter>& parameters = camera.seen.calibration.parameters;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        parameters[i].value *= i < 2 ? (trial % 4 < 2 ? 1.1 : 0.9) : (i < 4 ? 1 : 0);
      }
    }
    const auto solved = solve_strobl(run.cameras, run.base_from_hand, with(scene.robot.setup));
    const auto truth = fit_from_truth(scene, run);
    ASSERT_TRUE(truth.has_value()) << trial;
    if (!solved || difference(*solved, *truth) > 0.03) ++elsewhere;
  }
  std::cout << elsewhere << " of " << trials << " refused or at another optimum\n";
  EXPECT_LE(elsewhere, trials / 50);
}

TEST_P(Strobl, LeavesOutAPoseThatContradictsTheOthers) {
  Random random(7);
  const StroblScene scene = scenes::random_strobl(EyeSetup::kInHand, GetParam(), random);
  StroblRun run = scenes::random_strobl_run(scene, kPoses, random);
  ASSERT_TRUE(scenes::solve_cameras(run, false));
  run.base_from_hand[4].translation[1] += 0.05;
  run.cameras[0].seen.views[6].observation.uv[3].u += 3;
  const auto solved = solve_strobl(run.cameras, run.base_from_hand);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_EQ(solved->hand_eye.poses, static_cast<int>(solved->loops.size()) - 1);
  for (const LoopError& loop : solved->loops) EXPECT_EQ(loop.used, loop.view != 4);
  EXPECT_NEAR(solved->hand_eye.corner_factor, 1, 0.05);
  EXPECT_LT(scenes::mount_error(solved->hand_eye, scene.robot.mount_from_camera).largest, 4.5);
}

// A noise that is given is used; a pitch and an aspect that are known are held.
TEST_P(Strobl, BelievesWhatIsGiven) {
  const int trials = scenes::full_count() ? 200 : 10;
  double squares = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(8000 + static_cast<std::uint64_t>(trial));
    StroblScene scene = scenes::random_strobl(kSetups[trial % 2], GetParam(), random);
    scene.robot.scale = scene.aspect = 1;
    const StroblRun run = scenes::random_strobl_run(scene, kPoses, random);
    StroblOptions options = with(scene.robot.setup);
    options.turn_sigma = scene.robot.turn_sigma;
    options.place_sigma = scene.robot.place_sigma;
    options.pitch_known = options.aspect_known = true;
    const auto solved = solve_strobl(run.cameras, run.base_from_hand, options);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_EQ(solved->hand_eye.robot_turn_sigma, scene.robot.turn_sigma);
    EXPECT_EQ(solved->hand_eye.robot_place_sigma, scene.robot.place_sigma);
    EXPECT_FALSE(solved->hand_eye.scale || solved->hand_eye.aspect);
    EXPECT_EQ(solved->names.back(), "carrier.tz");
    squares += scenes::strobl_square(*solved, scene) / trials;
  }
  std::cout << "mean of e^T C^-1 e / dof = " << squares << '\n';
  // The mean over 10 robots of some 20 numbers has a sigma of 0.1 by itself.
  EXPECT_NEAR(squares, 1, scenes::full_count() ? 0.1 : 0.3);
}

// ---- Step by step -------------------------------------------------------------------------------

// Sums of squared errors of one way to go.
struct Errors {
  double focal = 0;     // of the first camera, of its length
  double turn = 0;      // rad, of the mount
  double place = 0;     // m
  double pitch = 0;     // of its length
  double baseline = 0;  // m, between two cameras
  int count = 0;

  void add(const StroblScene& scene, const Calibration& camera, const HandEye& hand_eye,
           const std::optional<SE3>& first_from_second) {
    ++count;
    focal += std::pow(camera.parameters[0].value / scene.cameras[0].fx() - 1, 2);
    const SE3 mount = to_se3(hand_eye.mount_from_camera);
    const SE3& truth = scene.robot.mount_from_camera;
    turn += log_so3(mount.rotation * truth.rotation.transpose()).squaredNorm();
    place += (mount.translation - truth.translation).squaredNorm();
    pitch += std::pow(hand_eye.scale.value().value / scene.robot.scale - 1, 2);
    if (!first_from_second) return;
    baseline += (first_from_second->translation - scene.camera_from_first[1].inverse().translation)
                    .squaredNorm();
  }
  void print(const char* name) const {
    const auto rms = [&](double sum) { return std::sqrt(sum / count); };
    std::cout << "  " << name << ": focal length " << 100 * rms(focal) << " %, camera on the hand "
              << 1e3 * rms(turn) << " mrad, " << 1e3 * rms(place) << " mm, pitch "
              << 100 * rms(pitch) << " %";
    if (baseline > 0) std::cout << ", second camera " << 1e3 * rms(baseline) << " mm";
    std::cout << '\n';
  }
};

// calvin-solve, calvin-hand-eye --free-scale and calvin-rig, whose lengths are then the robot's.
bool add_steps(const StroblScene& scene, StroblRun run, bool aspect, Errors& errors) {
  if (!scenes::solve_cameras(run, aspect)) return false;
  HandEyeOptions options;
  options.setup = scene.robot.setup;
  options.free_scale = true;
  std::vector<Pose> hands;
  for (const std::size_t pose : run.cameras[0].pose_of_view) {
    hands.push_back(run.base_from_hand[pose]);
  }
  const auto hand_eye = solve_hand_eye(run.cameras[0].seen, hands, options);
  if (!hand_eye) return false;
  std::optional<SE3> second;
  if (run.cameras.size() > 1) {
    const auto rig = solve_rig({run.cameras[0].seen, run.cameras[1].seen});
    if (!rig) return false;
    second = to_se3(rig->rig.cameras[1].rig_from_camera);
    second->translation *= hand_eye->result.scale.value().value;
  }
  errors.add(scene, run.cameras[0].seen.calibration, hand_eye->result, second);
  return true;
}

// Root mean square errors of all ways over random robots, each with a board of a random aspect or a
// true one.
struct Ways {
  Errors jointly;
  Errors by_steps;
  Errors with_aspect;
};
void go_all_ways(std::size_t cameras, bool is_true, int trials, Ways& ways) {
  for (int trial = 0; trial < trials; ++trial) {
    Random random(2000 + static_cast<std::uint64_t>(trial));
    StroblScene scene = scenes::random_strobl(kSetups[trial % 2], cameras, random);
    if (is_true) scene.aspect = 1;
    StroblRun run = scenes::random_strobl_run(scene, kPoses, random);
    ASSERT_TRUE(add_steps(scene, run, false, ways.by_steps)) << trial;
    ASSERT_TRUE(add_steps(scene, run, true, ways.with_aspect)) << trial;
    ASSERT_TRUE(scenes::solve_cameras(run, false)) << trial;
    const auto solved = solve_strobl(run.cameras, run.base_from_hand, with(scene.robot.setup));
    ASSERT_TRUE(solved.has_value()) << trial << ": " << solved.error().message;
    std::optional<SE3> second;
    if (solved->rig) second = to_se3(solved->rig->cameras[1].rig_from_camera);
    ways.jointly.add(scene, solved->calibrations[0], solved->hand_eye, second);
  }
  std::cout << trials << " robots with " << cameras << " camera(s)"
            << (is_true ? ", boards of true aspect" : "") << ", root mean square errors\n";
  ways.by_steps.print("step by step");
  ways.with_aspect.print("with the aspect in the first step");
  ways.jointly.print("jointly");
}

TEST_P(Strobl, IsNoWorseThanStepByStep) {
  Ways ways;
  go_all_ways(GetParam(), false, scenes::full_count() ? 200 : 10, ways);
  for (const Errors* steps : {&ways.by_steps, &ways.with_aspect}) {
    EXPECT_LE(ways.jointly.focal, steps->focal);
    EXPECT_LE(ways.jointly.turn, steps->turn);
    EXPECT_LE(ways.jointly.place, steps->place);
    EXPECT_LE(ways.jointly.pitch, steps->pitch);
    EXPECT_LE(ways.jointly.baseline, steps->baseline);
  }
  if (!scenes::full_count()) return;
  // Where the steps suppose what is true.
  Ways of_true;
  go_all_ways(GetParam(), true, 200, of_true);
  EXPECT_LE(of_true.jointly.place, 1.1 * of_true.by_steps.place);
  EXPECT_LE(of_true.jointly.pitch, 1.1 * of_true.by_steps.pitch);
  EXPECT_LE(of_true.jointly.baseline, 1.1 * of_true.by_steps.baseline);
}

}  // namespace
}  // namespace calvin
