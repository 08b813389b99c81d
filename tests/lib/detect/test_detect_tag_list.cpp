// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Single tags at known places: each is found by itself, wherever it lies and whichever way it is
// turned, on a plane or in space, and together they calibrate a camera.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

// Five tags of two sizes in the plane of a wall, each turned by itself.
constexpr const char* kWall =
    "apriltag:tag36h11:60mm:0=0,0+3=250mm,-40mm,30+7/90mm=120mm,140mm,-75+12=-30mm,180mm,180+"
    "31=290mm,190mm,45";
// On three sides of a cube of 130 mm that meet in a corner.
constexpr const char* kCube =
    "aruco:80mm:5=0,0,-65mm,0,0,0+6=65mm,0,0,0,-90,0+8=0,-65mm,0,-90,0,0:DICT_5X5_100";

class TagLists : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  }
};

double distance(const Pixel& a, const Pixel& b) { return std::hypot(a.u - b.u, a.v - b.v); }

// px, of all corners, which have to be those of the truth.
double worst_error(const Observation& seen, const Observation& truth) {
  EXPECT_EQ(seen.ids, truth.ids);
  double worst = 0;
  for (std::size_t i = 0; i < std::min(seen.uv.size(), truth.uv.size()); ++i) {
    worst = std::max(worst, distance(seen.uv[i], truth.uv[i]));
  }
  return worst;
}

TEST_F(TagLists, OnAPlaneAreFoundWithTheirOwnNames) {
  const Board board = parse_board(kWall).value();
  EXPECT_EQ(board.point_count(), 20);
  EXPECT_TRUE(board.as<TagList>()->is_flat());
  const Camera camera = default_camera({960, 720});
  const auto detector = make_detector(board).value();
  const Motion motion(MotionKind::kRandom, camera, board, 5);
  for (int i = 0; i < 8; ++i) {
    const SE3 pose = motion.camera_from_board(i);
    const GrayImage image = render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
    const Observation truth = true_observation(camera, board, pose);
    ASSERT_EQ(truth.ids, board.ids());
    const Observation seen = detector->detect(image.view()).observation;
    EXPECT_EQ(seen.board, board.text());
    EXPECT_LT(worst_error(seen, truth), 0.2) << i;
  }
}

TEST_F(TagLists, InSpaceAreFoundFromAnySide) {
  const Board board = parse_board(kCube).value();
  EXPECT_FALSE(board.as<TagList>()->is_flat());
  const Camera camera = default_camera({960, 720});
  const auto detector = make_detector(board).value();
  // Towards one side of the cube, an edge between two and the corner of three.
  const struct {
    Eigen::Vector3d turn;
    std::size_t corners;
  } kViews[] = {{{0, 0, 0}, 4}, {{0, 0.7, 0}, 8}, {{0.6, 0.6, 0.2}, 12}, {{0.7, 0, 0}, 8}};
  for (const auto& [turn, corners] : kViews) {
    const SE3 pose = {exp_so3(turn), {0.01, 0, 0.5}};
    const Observation truth = true_observation(camera, board, pose);
    ASSERT_EQ(truth.ids.size(), corners) << turn.transpose();
    const GrayImage image = render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
    const Observation seen = detector->detect(image.view()).observation;
    EXPECT_LT(worst_error(seen, truth), 0.15) << turn.transpose();
  }
}

// From behind a card is blank, and another tag of the family is none of the list.
TEST_F(TagLists, HaveNoOtherTags) {
  const Camera camera = default_camera({640, 480});
  const Board board = parse_board(kWall).value();
  const auto detector = make_detector(board).value();
  const SE3 behind = {exp_so3({0, 3.1, 0}), {0.1, -0.05, 0.8}};
  EXPECT_FALSE(true_observation(camera, board, behind).found());
  EXPECT_FALSE(detector->detect(render_board(camera, board, behind).view()).observation.found());
  const Board other = parse_board("apriltag:tag36h11:60mm:1=0,0+4=250mm,0").value();
  const SE3 pose = {exp_so3({0.1, 0.2, 0.3}), {-0.1, 0, 0.6}};
  const GrayImage image = render_board(camera, other, pose, {.noise = 2, .blur = 0.7});
  EXPECT_FALSE(detector->detect(image.view()).observation.found());
  EXPECT_TRUE(make_detector(other).value()->detect(image.view()).observation.found());
}

// A list and a grid of the same family in one picture, and in one list of boards.
TEST_F(TagLists, AreToldFromGrids) {
  const Board grid = parse_board("apriltag:tag36h11:2x2:40mm:10mm:first=100").value();
  const Board list = parse_board("apriltag:tag36h11:60mm:0=0,0+3=90mm,0").value();
  const Camera camera = Camera::make("pinhole", {640, 480}, {600, 600, 319.5, 239.5}).value();
  const auto detector = make_detector(std::vector<Board>{list, grid}).value();
  for (const Board& shown : {grid, list}) {
    const SE3 pose = {exp_so3({0.2, 0.1, 0.4}), {-0.03, -0.03, 0.4}};
    const GrayImage image = render_board(camera, shown, pose, {.noise = 2, .blur = 0.7});
    const auto seen = detector->detect_all(image.view());
    ASSERT_EQ(seen.size(), 2U);
    EXPECT_EQ(seen[0].observation.found(), shown == list);
    EXPECT_EQ(seen[1].observation.found(), shown == grid);
    const Observation& own = seen[shown == list ? 0 : 1].observation;
    EXPECT_LT(worst_error(own, true_observation(camera, shown, pose)), 0.3);
  }
}

TEST_F(TagLists, CalibrateACamera) {
  for (const char* text : {kWall, kCube}) {
    const Board board = parse_board(text).value();
    const Camera camera = default_camera({960, 720});
    const auto detector = make_detector(board).value();
    const Motion motion(MotionKind::kRandom, camera, board, 7);
    std::vector<View> views;
    for (int i = 0; views.size() < 16 && i < 200; ++i) {
      const SE3 pose = motion.camera_from_board(i);
      const GrayImage image = render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
      const Observation seen = detector->detect(image.view()).observation;
      if (seen.ids.size() >= 8) views.push_back({.observation = seen, .board = board});
    }
    ASSERT_EQ(views.size(), 16U);
    SolveOptions options;
    options.model = "brown5";
    const auto solution = solve(views, {960, 720}, options);
    ASSERT_TRUE(solution) << text << ": " << solution.error().message;
    const Parameter fx = *solution->calibration.find("fx");
    std::cout << text << ": fx " << fx.value << " +- " << *fx.sigma << ", true " << camera.fx()
              << ", rms " << *solution->calibration.rms << " px\n";
    EXPECT_NEAR(fx.value, camera.fx(), 4 * *fx.sigma);
    EXPECT_LT(*fx.sigma, 0.004 * camera.fx());
  }
}

}  // namespace
}  // namespace calvin
