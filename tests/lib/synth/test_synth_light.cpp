// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A light as it is rendered: where the truth has it, of the size that distance and blur give it,
// from all sides, and in every motion.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

const Board kLight = PointLight{};

Camera fisheye() {
  return Camera::make("fisheye", {640, 480}, {180, 181, 322, 238, 0.01, -0.004, 0.001, -2e-4})
      .value();
}

// Middle and variances of what is brighter than the room.
struct Moments {
  double sum = 0;
  Pixel centre;
  double uu = 0;
  double vv = 0;
};

Moments moments_of(const GrayImage& image, double room) {
  Moments m;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double above = image.view().at(x, y) - room;
      m.sum += above;
      m.centre.u += above * x;
      m.centre.v += above * y;
    }
  }
  m.centre = {m.centre.u / m.sum, m.centre.v / m.sum};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double above = image.view().at(x, y) - room;
      m.uu += above / m.sum * (x - m.centre.u) * (x - m.centre.u);
      m.vv += above / m.sum * (y - m.centre.v) * (y - m.centre.v);
    }
  }
  return m;
}

TEST(LightScene, IsAGaussianWhereTheTruthIs) {
  const Camera camera = Camera::make("pinhole", {160, 120}, {2000, 1500, 79.5, 59.5}).value();
  scenes::Random random(1);
  for (int i = 0; i < 40; ++i) {
    const double distance = scenes::uniform(random, 0.8, 2.4);
    const double blur = scenes::uniform(random, 0.5, 2);
    const SE3 pose = {exp_so3({1, 2, 0.3 * i}),
                      {distance * scenes::uniform(random, -0.015, 0.015),
                       distance * scenes::uniform(random, -0.015, 0.015), distance}};
    const GrayImage image =
        render_board(camera, kLight, pose, {.blur = blur, .dark = 0, .glow = 240});
    const Observation truth = true_observation(camera, kLight, pose);
    ASSERT_EQ(truth.ids, std::vector<int>{0});
    const Moments m = moments_of(image, 0);
    EXPECT_NEAR(m.centre.u, truth.uv[0].u, 0.02) << i;
    EXPECT_NEAR(m.centre.v, truth.uv[0].v, 0.02) << i;
    // Of the ball, the blur and the pixel; levels below a half are rounded away.
    const double ball = PointLight::kDiameter / 4 / distance;
    EXPECT_NEAR(m.uu, std::pow(2000 * ball, 2) + blur * blur + 1.0 / 12, 0.05 * m.uu + 0.1) << i;
    EXPECT_NEAR(m.vv, std::pow(1500 * ball, 2) + blur * blur + 1.0 / 12, 0.05 * m.vv + 0.1) << i;
    const double flux = 240 * 2 * std::numbers::pi * 2000 * ball * 1500 * ball;
    EXPECT_NEAR(m.sum, flux, 0.03 * flux) << "as bright however blurred";
  }
}

// Each light of a wand is where the truth is: the brightest pixel is the one that it is in.
TEST(LightScene, OfAWandHasEachOfItsLights) {
  const Camera camera = Camera::make("pinhole", {640, 480}, {500, 500, 319.5, 239.5}).value();
  const Board wand = PointLight{{0, 0.15, 0.5}};
  const SE3 pose{exp_so3({0.2, 0.5, 1}), {-0.1, -0.2, 1.5}};
  const Observation truth = true_observation(camera, wand, pose);
  ASSERT_EQ(truth.ids, (std::vector<int>{0, 1, 2}));
  const GrayImage image = render_board(camera, wand, pose, {.noise = 0, .blur = 0.8, .glow = 150});
  for (const Pixel& at : truth.uv) {
    const int u = static_cast<int>(std::lround(at.u));
    const int v = static_cast<int>(std::lround(at.v));
    for (const Pixel& way : {Pixel{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      EXPECT_GE(image.view().at(u, v),
                image.view().at(u + static_cast<int>(way.u), v + static_cast<int>(way.v)));
    }
    EXPECT_GT(image.view().at(u, v), image.view().at(u + 20, v) + 50);
  }
}

TEST(LightScene, IsSeenFromAllSides) {
  const Camera camera = default_camera({320, 240});
  const SE3 facing = {Eigen::Matrix3d::Identity(), {0.1, -0.05, 1}};
  const SE3 behind = {exp_so3({0, std::numbers::pi, 0}), facing.translation};
  EXPECT_EQ(true_observation(camera, kLight, behind).ids, std::vector<int>{0});
  EXPECT_EQ(render_board(camera, kLight, facing).pixels,
            render_board(camera, kLight, behind).pixels);
  const SE3 away = {facing.rotation, {0, 0, -1}};
  EXPECT_FALSE(true_observation(camera, kLight, away).found());
  for (const auto level : render_board(camera, kLight, away).pixels) EXPECT_EQ(level, 30);
}

TEST(LightScene, IsInTheImageInEveryMotion) {
  for (const Camera& camera : {default_camera({640, 480}), fisheye()}) {
    for (const auto kind :
         {MotionKind::kRandom, MotionKind::kOrbit, MotionKind::kHand, MotionKind::kStatic}) {
      const Motion motion(kind, camera, kLight, 1);
      double left = 1e9;
      double right = -1e9;
      for (int t = 0; t < 60; ++t) {
        const SE3 pose = motion.camera_from_board(t);
        const Observation truth = true_observation(camera, kLight, pose);
        ASSERT_TRUE(truth.found()) << static_cast<int>(kind) << " " << t;
        left = std::min(left, truth.uv[0].u);
        right = std::max(right, truth.uv[0].u);
        EXPECT_GE(pose.translation.norm(), 0.79);
        EXPECT_LE(pose.translation.norm(), 2.41);
      }
      if (kind == MotionKind::kStatic) {
        EXPECT_EQ(left, right);
      } else {
        EXPECT_GT(right - left, 300) << static_cast<int>(kind);
      }
    }
  }
}

// A rolling shutter shows the light where it is while its row is read.
TEST(LightScene, IsWhereItIsWhenItsRowIsRead) {
  const Camera camera = Camera::make("pinhole", {320, 240}, {300, 300, 159.5, 119.5}).value();
  const PoseOfRow pose = [](double v) {
    return SE3{Eigen::Matrix3d::Identity(), {0.1 + 2e-3 * (v - 120), 0.05, 1}};
  };
  const BoardRenderer renderer(camera);
  const Observation truth = true_observation(camera, kLight, pose);
  const Moments m =
      moments_of(renderer.render(kLight, pose, {.blur = 1, .dark = 0, .glow = 240}), 0);
  EXPECT_NEAR(m.centre.v, truth.uv[0].v, 0.02);
  EXPECT_NEAR(m.centre.u, truth.uv[0].u, 0.02);
  EXPECT_GT(std::abs(truth.uv[0].u - camera.project(pose(0).translation)->u), 50);
}

TEST(LightScene, HasLampsThatStandStill) {
  const Camera camera = default_camera({640, 480});
  const SE3 away = {Eigen::Matrix3d::Identity(), {0, 0, -1}};
  const GrayImage dark = render_board(camera, kLight, away, {.lamps = 0});
  const GrayImage lit = render_board(camera, kLight, away, {.lamps = 4});
  int bright = 0;
  for (const auto level : lit.pixels) bright += level == 255 ? 1 : 0;
  EXPECT_GT(bright, 100);
  EXPECT_EQ(lit.pixels, render_board(camera, kLight, away, {.seed = 9, .lamps = 4}).pixels);
  EXPECT_NE(lit.pixels, dark.pixels);
}

}  // namespace
}  // namespace calvin
