// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board without a grid and with gaps in its ids takes every way that a checkerboard takes, but
// the detector: rendering, drawing, the session and the solve.
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/draw/board_drawing.hpp"
#include "calvin/session/session.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin_config.h"
#include "scenes.hpp"

namespace calvin {
namespace {

// 40 dots, none of them in line with others, ids 5, 8, 11, ...
Board scattered_dots() {
  scenes::Random random(3);
  std::vector<PointBoard::Dot> dots;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.04 * (i % 8) + scenes::uniform(random, -0.008, 0.008) - 0.1;
    const double y = 0.04 * (i / 8) + scenes::uniform(random, -0.008, 0.008) + 0.05;
    dots.push_back({5 + 3 * i, x, y, scenes::uniform(random, 0.012, 0.018)});
  }
  return PointBoard::make("scattered", dots).value();
}

const Board kDots = scattered_dots();

TEST(GridlessBoard, IsRenderedWhereItsPointsAre) {
  const Camera camera = Camera::make("pinhole", {800, 600}, {900, 900, 399.5, 299.5}).value();
  const SE3 pose = {exp_so3({0, 0, 0.3}), {0, -0.12, 0.6}};  // frontal: circles stay circles
  const GrayImage image = render_board(camera, kDots, pose);
  const Observation truth = true_observation(camera, kDots, pose);
  ASSERT_EQ(truth.ids, kDots.ids());
  EXPECT_TRUE(truth.ambiguous.empty());
  const auto& dots = kDots.as<PointBoard>()->dots();
  for (std::size_t i = 0; i < truth.uv.size(); ++i) {
    const double radius = dots[i].diameter / 2 * 900 / 0.6;
    double dark = 0;
    double u = 0;
    double v = 0;
    const int reach = static_cast<int>(radius) + 3;
    const int column = static_cast<int>(std::lround(truth.uv[i].u));
    const int row = static_cast<int>(std::lround(truth.uv[i].v));
    for (int y = row - reach; y <= row + reach; ++y) {
      for (int x = column - reach; x <= column + reach; ++x) {
        const double ink = (220.0 - image.view().at(x, y)) / 190;
        dark += ink;
        u += ink * x;
        v += ink * y;
      }
    }
    // A grey level has 1/190 of the ink of a pixel: the rim's roundings leave so much.
    EXPECT_NEAR(u / dark, truth.uv[i].u, 0.01) << truth.ids[i];
    EXPECT_NEAR(v / dark, truth.uv[i].v, 0.01) << truth.ids[i];
    EXPECT_NEAR(std::sqrt(dark / std::numbers::pi), radius, 0.01) << truth.ids[i];
  }
}

TEST(GridlessBoard, IsABlankCardFromBehind) {
  const Camera camera = Camera::make("pinhole", {320, 240}, {360, 360, 159.5, 119.5}).value();
  const SE3 pose = {exp_so3({0, std::numbers::pi, 0}), {0, -0.12, 0.6}};
  EXPECT_FALSE(true_observation(camera, kDots, pose).found());
  const GrayImage image = render_board(camera, kDots, pose);
  for (const std::uint8_t level : image.pixels) EXPECT_GE(level, 127);
}

TEST(GridlessBoard, LiesInTheImageInEveryMotion) {
  const Camera camera = default_camera({640, 480});
  for (const auto kind : {MotionKind::kRandom, MotionKind::kOrbit, MotionKind::kHand}) {
    const Motion motion(kind, camera, kDots, 1);
    for (int t = 0; t < 10; ++t) {
      const auto seen = true_observation(camera, kDots, motion.camera_from_board(t));
      EXPECT_EQ(seen.ids.size(), 40u) << static_cast<int>(kind) << " " << t;
    }
  }
}

TEST(GridlessBoard, IsTakenByTheSessionAndSolved) {
  scenes::Random random(11);
  const Camera camera = scenes::random_camera("brown5", random);
  Session session({CaptureMode::kAll, 3, 0});
  std::vector<View> views;
  for (const SE3& pose : scenes::random_poses(camera, kDots, random, 20)) {
    View view = {true_observation(camera, kDots, pose), kDots};
    // Some of the dots are covered.
    for (int n = 0; n < 7; ++n) {
      const auto at = static_cast<std::ptrdiff_t>(random() % view.observation.ids.size());
      view.observation.ids.erase(view.observation.ids.begin() + at);
      view.observation.uv.erase(view.observation.uv.begin() + at);
      view.observation.sigma.erase(view.observation.sigma.begin() + at);
    }
    EXPECT_EQ(session.offer(view), Reason::kAccepted);
    views.push_back(std::move(view));
  }
  EXPECT_GT(session.progress().coverage, 0.5);
  const auto solution = solve(views, scenes::kSize);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  EXPECT_EQ(solution->calibration.board, kDots.text());
  EXPECT_LT(solution->calibration.rms, 1e-6);
  for (std::size_t i = 0; i < camera.parameters().size(); ++i) {
    EXPECT_NEAR(solution->calibration.parameters[i].value, camera.parameters()[i],
                1e-6 * (1 + std::abs(camera.parameters()[i])));
  }
}

TEST(GridlessBoard, AWrongCornerIsNamedByItsId) {
  scenes::Random random(12);
  const Camera camera = scenes::random_camera("brown5", random);
  std::vector<View> views;
  for (const SE3& pose : scenes::random_poses(camera, kDots, random, 20)) {
    views.push_back(scenes::observe(camera, kDots, pose, 0.05, random));
  }
  views[4].observation.uv[17].u += 9;
  const int id = views[4].observation.ids[17];
  EXPECT_GT(id, 40) << "an id that is no index";
  const auto solution = solve(views, scenes::kSize);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  ASSERT_EQ(solution->rejected_corners.size(), 1u);
  EXPECT_EQ(solution->rejected_corners[0].view, 4u);
  EXPECT_EQ(solution->rejected_corners[0].id, id);
}

TEST(GridlessBoard, ItsBendIsMeasured) {
  scenes::Random random(13);
  const Camera camera = scenes::random_camera("brown5", random);
  const BoardArea area = kDots.extent();
  const double kx = 0.002;
  std::vector<View> views;
  for (const SE3& pose : scenes::random_poses(camera, kDots, random, 20)) {
    View view = {true_observation(camera, kDots, pose), kDots};
    const auto points = kDots.points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double x = 2 * (points[i].x() - area.left) / area.width() - 1;
      const Eigen::Vector3d bent = points[i] + Eigen::Vector3d(0, 0, kx * (1 - x * x));
      view.observation.uv[i] = camera.project(pose * bent).value();
    }
    view.observation.sigma.assign(points.size(), 0.02);
    views.push_back(std::move(view));
  }
  SolveOptions options;
  options.warp = true;
  const auto solution = solve(views, scenes::kSize, options);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  ASSERT_TRUE(solution->calibration.warp.has_value());
  EXPECT_NEAR(solution->calibration.warp->kx, kx, 1e-6);
  EXPECT_NEAR(solution->calibration.warp->ky, 0, 1e-6);
}

TEST(GridlessBoard, HasNoDetectorAndThatIsSaid) {
  const auto detector = make_detector(kDots);
  ASSERT_FALSE(detector.has_value());
  EXPECT_EQ(detector.error().code, ErrorCode::kUnsupported);
}

#if CALVIN_HAVE_CAIRO
TEST(GridlessBoard, IsDrawnWithItsDotsInTheirPlaces) {
  const auto svg = draw_board(kDots, {DrawingFormat::kSvg, "auto"});
  ASSERT_TRUE(svg.has_value()) << svg.error().message;
  std::size_t arcs = 0;
  for (std::size_t at = svg->find(" C "); at != std::string::npos; at = svg->find(" C ", at + 1)) {
    ++arcs;
  }
  EXPECT_GE(arcs, 160u) << "four curves for each dot";
  const auto page = lay_out_board(kDots, "auto");
  ASSERT_TRUE(page.has_value());
  const BoardArea outline = kDots.outline();
  EXPECT_GT(page->x + outline.left, 0.005);
  EXPECT_GT(page->y + outline.top, 0.005);
  EXPECT_LT(page->x + outline.right, page->width - 0.005);
}
#endif

}  // namespace
}  // namespace calvin
