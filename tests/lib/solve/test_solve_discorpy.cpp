// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The distortion alone, by one picture of a plane: against the camera that made it, its errors
// against their covariance, and what it cannot tell refused.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "calvin/detect/detector.hpp"
#include "calvin/solve/residuals/straightness.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kSize;
using scenes::uniform;
using Random = scenes::Random;

const CircleGrid kGrid = {40, 30, 0.005, {}, {}, false};

SolveOptions discorpy(const char* model = "brown5") {
  SolveOptions options;
  options.method = "discorpy";
  options.model = model;
  return options;
}

// A lens with radial distortion alone, of about `bend` of a radius at the corner.
Camera camera_of(Random& random, double bend = 0.1) {
  const double f = kSize.width * uniform(random, 1, 3);
  const double corner = std::hypot(kSize.width / 2, kSize.height / 2) / f;
  const double k1 = uniform(random, 0.5, 1) * bend / std::pow(corner, 2);
  return Camera::make(
             "brown5", kSize,
             {f, f, kSize.width * uniform(random, 0.45, 0.55),
              kSize.height * uniform(random, 0.45, 0.55), uniform(random, 0, 1) < 0.5 ? -k1 : k1,
              uniform(random, -0.2, 0.2) * bend / std::pow(corner, 4), 0, 0,
              uniform(random, -0.05, 0.05) * bend / std::pow(corner, 6)})
      .value();
}

// The grid before all of the picture and beyond, nearly parallel to it: what is in view of it.
View view_of(const Camera& camera, double tilt, double sigma, Random& random) {
  const Board board = kGrid;
  const BoardArea area = board.extent();
  SE3 pose = {exp_so3({uniform(random, -tilt, tilt), uniform(random, -tilt, tilt),
                       uniform(random, -0.1, 0.1)}),
              {}};
  pose.translation = Eigen::Vector3d(0, 0, 0.95 * camera.fx() * area.width() / kSize.width) -
                     pose.rotation * Eigen::Vector3d(area.width() / 2, area.height() / 2, 0);
  View view;
  view.board = board;
  view.observation = true_observation(camera, board, pose);
  std::normal_distribution<double> noise(0, sigma);
  for (Pixel& p : view.observation.uv) p = {p.u + noise(random), p.v + noise(random)};
  view.observation.sigma.assign(view.observation.ids.size(), sigma > 0 ? sigma : 1);
  return view;
}

// The parameters that a camera of another focal length has for the same distortion in px.
std::vector<double> with_focal(const Camera& camera, double f) {
  std::vector<double> p = camera.parameters();
  const double square = std::pow(f / p[0], 2);
  p[4] *= square;
  p[5] *= square * square;
  p[8] *= square * square * square;
  return {p[2], p[3], p[4], p[5], p[8]};
}

std::vector<double> estimated(const Calibration& c) {
  std::vector<double> all;
  for (const char* name : {"cx", "cy", "k1", "k2", "k3"}) all.push_back(c.find(name)->value);
  return all;
}

TEST(Discorpy, FindsTheDistortionOfPointsWithoutNoise) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Camera camera = camera_of(random);
    const View view = view_of(camera, 0.3, 0, random);
    const auto found = solve(std::vector{view}, kSize, discorpy());
    ASSERT_TRUE(found) << found.error().message;
    const Calibration& c = found->calibration;
    const auto truth = with_focal(camera, kSize.width);
    const auto ours = estimated(c);
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(ours[k], truth[k], 1e-4);
    for (std::size_t k = 2; k < 5; ++k)
      EXPECT_NEAR(ours[k], truth[k], 1e-5 * (1 + std::abs(truth[k])));
    EXPECT_LT(*c.rms, 1e-6);
    EXPECT_EQ(c.find("fx")->value, kSize.width);
    EXPECT_FALSE(c.find("fx")->sigma) << "nobody has estimated it";
    EXPECT_FALSE(c.expected_error);
    EXPECT_TRUE(std::ranges::any_of(c.remarks, [](const std::string& remark) {
      return remark.find("focal length is not known") != std::string::npos;
    }));
    const auto straight =
        straightness(std::vector{view}, found->rejected_corners, Camera::make(c).value());
    ASSERT_TRUE(straight);
    EXPECT_GT(straight->lines, 50);
    EXPECT_GT(straight->seen, 0.3);
    EXPECT_LT(straight->mended, 1e-5);
  }
}

// 1000 with CALVIN_FULL=1.
TEST(Discorpy, HasErrorsAsItsCovarianceSays) {
  Random random(7);
  const int count = scenes::full_count() ? 2000 : 60;
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    const Camera camera = camera_of(random);
    const View view = view_of(camera, 0.1, 0.1, random);
    const auto found = solve(std::vector{view}, kSize, discorpy());
    ASSERT_TRUE(found) << found.error().message;
    const auto truth = with_focal(camera, kSize.width);
    const auto ours = estimated(found->calibration);
    const Eigen::Map<const Eigen::Matrix<double, 5, 5>> covariance(
        found->calibration.covariance.data());
    Eigen::Matrix<double, 5, 1> e;
    for (Eigen::Index k = 0; k < 5; ++k) {
      e[k] = ours[static_cast<std::size_t>(k)] - truth[static_cast<std::size_t>(k)];
    }
    sum += e.dot(covariance.ldlt().solve(e)) / 5;
  }
  std::cout << "mean of e^T C^-1 e / 5 = " << sum / count << '\n';
  EXPECT_NEAR(sum / count, 1, scenes::full_count() ? 0.1 : 0.25);
}

TEST(Discorpy, TakesSeveralViewsAndLeavesOutliersOut) {
  Random random(11);
  const Camera camera = camera_of(random);
  std::vector<View> views;
  for (int i = 0; i < 3; ++i) views.push_back(view_of(camera, 0.4, 0.05, random));
  views[1].observation.uv[100].u += 3;
  views[1].observation.uv[300].v -= 2;
  const auto found = solve(views, kSize, discorpy());
  ASSERT_TRUE(found) << found.error().message;
  std::set<int> out;
  for (const RejectedCorner& corner : found->rejected_corners) {
    if (corner.view == 1) out.insert(corner.id);
  }
  EXPECT_TRUE(out.contains(views[1].observation.ids[100]));
  EXPECT_TRUE(out.contains(views[1].observation.ids[300]));
  EXPECT_LT(found->rejected_corners.size(), 12u);
  EXPECT_NEAR(found->calibration.find("cx")->value, camera.cx(), 0.5);
  EXPECT_NEAR(found->calibration.find("cy")->value, camera.cy(), 0.5);
  EXPECT_EQ(found->calibration.views.size(), 3u);
}

TEST(Discorpy, FollowsAStrongLensByAQuotient) {
  Random random(13);
  const Camera camera =
      Camera::make("fisheye", kSize, {620, 620, 652, 470, 0.01, -0.004, 0, 0}).value();
  const View view = view_of(camera, 0.05, 0.02, random);
  const auto cubic = solve(std::vector{view}, kSize, discorpy("brown5"));
  const auto rational = solve(std::vector{view}, kSize, discorpy("rational8"));
  ASSERT_TRUE(cubic && rational);
  EXPECT_LT(*rational->calibration.rms, 0.03);
  EXPECT_LT(*rational->calibration.rms, 0.9 * *cubic->calibration.rms);
  EXPECT_NEAR(rational->calibration.find("cx")->value, 652, 0.1);
  EXPECT_NEAR(rational->calibration.find("cy")->value, 470, 0.1);
}

// The steps of discorpy itself: the centre to half of a pitch, 30 px here.
TEST(Discorpy, TakesItsOwnStepsWhereNothingIsRefined) {
  Random random(23);
  SolveOptions options = discorpy();
  options.refine = false;
  for (int i = 0; i < 10; ++i) {
    const Camera camera = camera_of(random);
    const auto found = solve(std::vector{view_of(camera, 0, 0.01, random)}, kSize, options);
    ASSERT_TRUE(found) << found.error().message;
    const Calibration& c = found->calibration;
    EXPECT_NEAR(c.find("cx")->value, camera.cx(), 25);
    EXPECT_NEAR(c.find("cy")->value, camera.cy(), 25);
    EXPECT_LT(*c.rms, 6);
    EXPECT_EQ(c.remarks.front().rfind("discorpy's own numbers: xcenter", 0), 0u);
  }
  const View view = view_of(camera_of(random), 0, 0.01, random);
  const auto two = solve(std::vector{view, view}, kSize, options);
  ASSERT_FALSE(two);
  EXPECT_NE(two.error().message.find("one view"), std::string::npos);
  View few = view;
  few.observation.ids.resize(160);  // four rows
  few.observation.uv.resize(160);
  few.observation.sigma.resize(160);
  const auto rows = solve(std::vector{few}, kSize, options);
  ASSERT_FALSE(rows);
  EXPECT_NE(rows.error().message.find("eight rows"), std::string::npos);
}

TEST(Discorpy, RefusesWhatItCannotTell) {
  Random random(17);
  const View view = view_of(camera_of(random), 0.1, 0.1, random);
  const auto refused = [](const View& v, const SolveOptions& options, const char* why) {
    const auto found = solve(std::vector{v}, kSize, options);
    ASSERT_FALSE(found) << why;
    EXPECT_NE(found.error().message.find(why), std::string::npos) << found.error().message;
  };
  refused(view, discorpy("fisheye"), "brown4, brown5 or rational8");
  View few = view;
  few.observation.ids.resize(6);
  few.observation.uv.resize(6);
  few.observation.sigma.resize(6);
  few.observation.ids[5] = few.observation.ids[0] + 80;
  refused(few, discorpy(), "more points");
}

TEST(Discorpy, SaysWhenTheLensHardlyBendsAnything) {
  Random random(19);
  const View view = view_of(camera_of(random, 1e-4), 0.1, 0.1, random);
  const auto found = solve(std::vector{view}, kSize, discorpy());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(std::ranges::any_of(found->calibration.remarks, [](const std::string& remark) {
    return remark.find("hardly known") != std::string::npos;
  }));
  SolveOptions centered = discorpy("brown4");
  centered.fix = {"center"};
  const auto held = solve(std::vector{view}, kSize, centered);
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_EQ(held->calibration.find("cx")->value, (kSize.width - 1) / 2.0);
  EXPECT_FALSE(held->calibration.find("cx")->sigma);
  EXPECT_TRUE(held->calibration.find("k1")->sigma);
}

// From pixels: dots and lines before a lens, the picture filled from side to side.
TEST(Discorpy, FindsTheDistortionOfRenderedGrids) {
  const Camera camera =
      Camera::make("brown5", kSize, {1500, 1500, 612, 491, -0.2, 0.05, 0, 0, 0}).value();
  for (const char* text : {"dots:1mm", "lines:1mm"}) {
    const Board board = parse_board(text).value();
    SE3 pose = {exp_so3({0.03, -0.02, 0.05}), {}};
    pose.translation = Eigen::Vector3d(0, 0, 1500 * 0.05 / kSize.width) -
                       pose.rotation * Eigen::Vector3d(0.1, 0.1, 0);
    RenderOptions options;
    options.blur = 0.8;
    options.noise = 2;
    const GrayImage image = render_board(camera, board, pose, options);
    Detection seen = make_detector(board).value()->detect(image.view());
    ASSERT_EQ(seen.reason, Reason::kAccepted) << text;
    const View view = {std::move(seen.observation), board};
    const auto found = solve(std::vector{view}, kSize, discorpy());
    ASSERT_TRUE(found) << found.error().message;
    const Calibration& c = found->calibration;
    for (const auto& [name, truth] : {std::pair{"cx", 612.0}, {"cy", 491.0}}) {
      const Parameter& p = *c.find(name);
      EXPECT_NEAR(p.value, truth, 4.5 * *p.sigma) << text << " " << name;
      EXPECT_NEAR(p.value, truth, 1) << text << " " << name;
    }
    const auto straight =
        straightness(std::vector{view}, found->rejected_corners, Camera::make(c).value());
    ASSERT_TRUE(straight);
    EXPECT_LT(straight->mended, 0.03) << text;
    EXPECT_GT(straight->seen, 1) << text;
    // Where a true pinhole would show points of the picture, after the best common scale.
    const Camera ours = Camera::make(c).value();
    double aa = 0;
    double ab = 0;
    std::vector<std::pair<double, double>> radii;
    for (double r = 20; r < 740; r += 20) {
      const auto ideal = camera.unproject({612 + r * 0.8, 491 + r * 0.6});
      const auto mine = ours.unproject({ours.cx() + r * 0.8, ours.cy() + r * 0.6});
      if (!ideal || !mine) continue;
      radii.emplace_back(1500 * ideal->hnormalized().norm(),
                         kSize.width * mine->hnormalized().norm());
      aa += radii.back().second * radii.back().second;
      ab += radii.back().first * radii.back().second;
    }
    EXPECT_GT(radii.size(), 30u);
    for (const auto& [a, b] : radii) EXPECT_NEAR(a, ab / aa * b, 0.1) << text;
  }
}

}  // namespace
}  // namespace calvin
