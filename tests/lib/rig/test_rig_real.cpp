// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pairs of real cameras, and one that others have rendered: where the second one stands before the
// first is what was published, or what is true.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/moved_camera.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "calvin/solve/solve.hpp"
#include "real_sets.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::optional<RigCameraViews> camera_of(const real::Set& set, const char* model) {
  real::Views read = real::read(set);
  if (read.views.empty()) return std::nullopt;
  SolveOptions options;
  options.model = model;
  auto solution = solve(read.views, read.size, options);
  if (!solution) {
    ADD_FAILURE() << set.name << ": " << solution.error().message;
    return std::nullopt;
  }
  RigCameraViews camera{std::move(solution->calibration), std::move(read.views)};
  camera.calibration.camera = set.name;
  return camera;
}

SE3 second_from_first(const Rig& rig) { return to_se3(rig.cameras[1].rig_from_camera).inverse(); }

void print(const RigSolution& solved) {
  for (const RigLink& link : solved.links) std::cout << to_text(link, solved.rig) << '\n';
  std::cout << "rms " << solved.rig.rms.value_or(0) << " px, " << solved.rejected.size()
            << " views rejected\n";
}

// J.-Y. Bouguet's result for these pictures, with its 3 sigma.
TEST(RealRig, IsWhatBouguetPublished) {
  auto left = camera_of({"left", "brown4", "opencv-samples", "left", "checkerboard:9x6:30mm", true},
                        "brown4");
  auto right = camera_of(
      {"right", "brown4", "opencv-samples", "right", "checkerboard:9x6:30mm", true}, "brown4");
  if (!left || !right) GTEST_SKIP() << "without CALVIN_DATA there is no opencv-samples";
  const auto solved = solve_rig({*left, *right});
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  print(*solved);
  const SE3 pose = second_from_first(solved->rig);
  const Eigen::Vector3d om = log_so3(pose.rotation);
  std::cout << "om " << om.transpose() << ", T " << 1e3 * pose.translation.transpose() << '\n';
  const Eigen::Vector3d published(0.00669, 0.00452, -0.00350);
  const Eigen::Vector3d place(-99.80198e-3, 1.12443e-3, 0.05041e-3);
  const Eigen::Vector3d om_error(0.0027, 0.0031, 0.0003);
  const Eigen::Vector3d place_error(0.14e-3, 0.11e-3, 0.50e-3);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(om(k), published(k), om_error(k));
    EXPECT_NEAR(pose.translation(k), place(k), place_error(k));
  }
  EXPECT_LE(solved->rig.rms.value(), 0.25);
  EXPECT_EQ(moved_cameras({*left, *right}, {}), "");
}

// 21 pairs of a simulation, of which everything is known.
SE3 dice_truth() {
  const auto turn = [](int axis, double degrees) {
    Eigen::Vector3d about = Eigen::Vector3d::Zero();
    about(axis) = degrees * kDegree;
    return exp_so3(about);
  };
  return {turn(2, 0.28140) * turn(1, -19.06769) * turn(0, 0.13069),
          {122.2488e-3, 1.84888e-3, 17.62463e-3}};
}

struct DiceCamera {
  const char* name;
  std::vector<double> truth;  // fx fy cx cy
};
const DiceCamera kDice[] = {{"0", {6673.3159, 6669.3027, 872.1577, 579.955}},
                            {"1", {6607.61, 6602.85, 917.973, 531.635}}};

// With focal lengths and centre as they are, or found.
std::optional<RigCameraViews> dice_camera(const DiceCamera& of, bool are_known) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder = std::filesystem::path(data == nullptr ? "" : data) / "dice-checkerboard";
  if (data == nullptr || !std::filesystem::is_directory(folder)) return std::nullopt;
  const Board board = parse_board("checkerboard:12x8:5mm").value();
  const auto detector = make_detector(board).value();
  RigCameraViews camera;
  for (std::size_t i = 0; i < 21; ++i) {
    const std::string number = std::to_string(100 + i).substr(1);
    const cv::Mat image =
        cv::imread((folder / (number + '_' + of.name + ".jpeg")).string(), cv::IMREAD_GRAYSCALE);
    auto seen = detector->detect(
        {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1});
    seen.observation.timestamp = 1000 * (i + 1);
    camera.views.push_back({std::move(seen.observation), board});
  }
  SolveOptions options;
  options.model = "brown5";
  if (are_known) {
    std::vector<double> start = of.truth;
    start.resize(9, 0.0);
    options.initial = Camera::make("brown5", {1920, 1200}, start).value().to_calibration();
    options.fix = {"fx", "fy", "center"};
  }
  auto solution = solve(camera.views, {1920, 1200}, options);
  if (!solution) {
    ADD_FAILURE() << solution.error().message;
    return std::nullopt;
  }
  camera.calibration = std::move(solution->calibration);
  camera.calibration.camera = of.name;
  return camera;
}

// All of both cameras in one least squares, from these pictures alone.
void expect_dice_of_both(const RigCameraViews& first, const RigCameraViews& second) {
  RigOptions options;
  options.intrinsics = RigIntrinsics::kFree;
  const auto solved = solve_rig({first, second}, options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  print(*solved);
  const auto error = scenes::place_error(solved->rig.cameras[1], dice_truth().inverse());
  std::cout << "with free intrinsics off by " << error.largest << " sigmas\n";
  EXPECT_LT(error.largest, 3);
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t i = 0; i < 4; ++i) {
      const Parameter& p = solved->rig.cameras[c].calibration.parameters[i];
      EXPECT_NEAR(p.value, kDice[c].truth[i], 0.5) << p.name;
    }
  }
}

// The board looks the same after half a turn.
TEST(RealRig, OfASimulationStandsWhereItIs) {
  for (const bool are_known : {true, false}) {
    auto first = dice_camera(kDice[0], are_known);
    auto second = dice_camera(kDice[1], are_known);
    if (!first || !second) GTEST_SKIP() << "without CALVIN_DATA there is no dice-checkerboard";
    const auto solved = solve_rig({*first, *second});
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    print(*solved);
    const SE3 truth = dice_truth();
    const SE3 pose = second_from_first(solved->rig);
    const Eigen::Vector3d turn = log_so3(pose.rotation * truth.rotation.transpose());
    const Eigen::Vector3d place = pose.translation - truth.translation;
    std::cout << "off by " << 1e3 * place.transpose() << " mm, " << turn.transpose() / kDegree
              << " degrees\n";
    if (are_known) {
      EXPECT_LT(place.cwiseAbs().maxCoeff(), 0.01e-3);
      EXPECT_LT(turn.cwiseAbs().maxCoeff(), 0.002 * kDegree);
    } else {
      const auto error = scenes::place_error(solved->rig.cameras[1], truth.inverse());
      EXPECT_LT(error.largest, 3);
      expect_dice_of_both(*first, *second);
    }
  }
}

TEST(RealRig, OfEurocHasItsBaseline) {
  auto first = camera_of({"yac0", "brown5", "aprilgrid-yac-points", "cam0", "", false}, "brown5");
  auto second = camera_of({"yac1", "brown5", "aprilgrid-yac-points", "cam1", "", false}, "brown5");
  if (!first || !second) GTEST_SKIP() << "without CALVIN_DATA there is no aprilgrid-yac-points";
  const auto solved = solve_rig({*first, *second});
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  print(*solved);
  EXPECT_NEAR(second_from_first(solved->rig).translation.norm(), 110.03e-3, 0.003 * 110.03e-3);
  EXPECT_EQ(moved_cameras({*first, *second}, {}), "");
}

TEST(RealRig, OfFisheyesIsSolved) {
  auto left = camera_of(
      {"left", "fisheye", "fisheye-stereo-stereopi", "left", "checkerboard:9x6:25mm", true},
      "fisheye");
  auto right = camera_of(
      {"right", "fisheye", "fisheye-stereo-stereopi", "right", "checkerboard:9x6:25mm", false},
      "fisheye");
  if (!left || !right) GTEST_SKIP() << "without CALVIN_DATA there is no fisheye-stereo-stereopi";
  const auto solved = solve_rig({*left, *right});
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  print(*solved);
  EXPECT_LE(solved->rig.rms.value(), 0.35);
  EXPECT_EQ(moved_cameras({*left, *right}, {}), "");
}

}  // namespace
}  // namespace calvin
