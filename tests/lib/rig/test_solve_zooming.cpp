// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views through a lens that zooms from one to the next: the closed form is exact where there is no
// noise and no distortion, the least squares find what noise and a bent lens hide, and planes that
// tell nothing are refused.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/rig/zoom/solve_zooming.hpp"
#include "zooming_scene.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;
using scenes::uniform;

using Lens = scenes::ZoomingLens;

std::vector<View> views_of(const Lens& lens, int count, double noise, Random& random) {
  return scenes::zooming_scene(lens, count, noise, random).views;
}

double value(const Calibration& calibration, const char* name) {
  return calibration.find(name)->value;
}

TEST(SturmMaybank, IsExactForAPinhole) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const Lens lens = {{640 + uniform(random, -20, 20), 480 + uniform(random, -20, 20)},
                       uniform(random, 0.98, 1.02)};
    const auto views = views_of(lens, 5, 0, random);
    ZoomingOptions options;
    options.refine = false;
    const auto found = solve_zooming(views, kSize, options);
    ASSERT_TRUE(found.has_value()) << found.error().message;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Camera truth = lens.at(static_cast<double>(i) / 4);
      EXPECT_NEAR(value((*found)[i], "fx") / truth.fx(), 1, 1e-6);
      EXPECT_NEAR(value((*found)[i], "fy") / truth.fy(), 1, 1e-6);
      EXPECT_NEAR(value((*found)[i], "cx"), lens.center.u, 1e-3);
      EXPECT_NEAR(value((*found)[i], "cy"), lens.center.v, 1e-3);
    }
  }
}

// With what is known before, fewer views do: one where all is.
TEST(SturmMaybank, TakesWhatIsKnownBefore) {
  Random random(2);
  const Lens lens = {image_center(kSize)};
  for (const int count : {1, 2}) {
    ZoomingOptions options;
    options.refine = false;
    options.square = true;
    options.centered = count == 1;
    const auto views = views_of(lens, count, 0, random);
    const auto found = solve_zooming(views, kSize, options);
    ASSERT_TRUE(found.has_value()) << found.error().message;
    EXPECT_NEAR(value(found->front(), "fx"), 900, 1e-3);
  }
}

// e^2 / sigma^2 of the focal lengths, through a lens that bends the corners by 40 px.
TEST(SolveZooming, FindsALensThatZoomsAndBends) {
  Random random(3);
  double sum = 0;
  int count = 0;
  int refused = 0;  // a view that tells nothing of its focal length, by chance
  double of_centers = 0;
  std::vector<double> by_itself;  // errors of fx, in parts
  std::vector<double> refined;
  const int rounds = scenes::full_count() ? 2000 : 5;
  for (int round = 0; round < rounds; ++round) {
    const Lens lens = {{640 + uniform(random, -12, 12), 480 + uniform(random, -12, 12)}, 1, 0.05};
    const auto views = views_of(lens, 10, 0.1, random);
    ZoomingOptions options;
    options.square = true;
    const auto found = solve_zooming(views, kSize, options);
    if (!found) {
      EXPECT_NE(found.error().message.find("does not tell"), std::string::npos);
      ++refused;
      continue;
    }
    options.refine = false;
    const auto closed_form = solve_zooming(views, kSize, options);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Camera truth = lens.at(static_cast<double>(i) / 9);
      if (closed_form) {
        by_itself.push_back(std::abs(value((*closed_form)[i], "fx") / truth.fx() - 1));
      }
      const Parameter& fx = *(*found)[i].find("fx");
      EXPECT_LT(std::abs(fx.value - truth.fx()) / fx.sigma.value(), 5.5) << "view " << i;
      refined.push_back(std::abs(fx.value / truth.fx() - 1));
      sum += std::pow((fx.value - truth.fx()) / fx.sigma.value(), 2);
      ++count;
      EXPECT_EQ(value((*found)[i], "fx"), value((*found)[i], "fy"));
      EXPECT_EQ(value((*found)[i], "cx"), value((*found)[0], "cx"));
    }
    const Parameter& cx = *found->front().find("cx");
    const Parameter& cy = *found->front().find("cy");
    of_centers += std::pow((cx.value - lens.center.u) / cx.sigma.value(), 2) / (2 * rounds);
    of_centers += std::pow((cy.value - lens.center.v) / cy.sigma.value(), 2) / (2 * rounds);
  }
  const auto median = [](std::vector<double> all) {
    std::ranges::sort(all);
    return all[all.size() / 2];
  };
  RecordProperty("median_by_itself", std::to_string(median(by_itself)));
  RecordProperty("median_refined", std::to_string(median(refined)));
  EXPECT_LT(5 * median(refined), median(by_itself));
  EXPECT_LE(refused, rounds / 500);
  RecordProperty("squared_error_over_predicted", std::to_string(sum / count));
  RecordProperty("of_centers", std::to_string(of_centers));
  // True over predicted is the root.
  const bool full = scenes::full_count();
  EXPECT_GT(of_centers, full ? 0.81 : 0.2);
  EXPECT_LT(of_centers, full ? 1.21 : 2.5);
  EXPECT_GT(sum / count, full ? 0.81 : 0.5);
  EXPECT_LT(sum / count, full ? 1.21 : 1.6);
}

std::string refusal(const std::vector<View>& views, ZoomingOptions options) {
  const auto found = solve_zooming(views, kSize, options);
  return found ? "" : found.error().message;
}

TEST(SolveZooming, RefusesPlanesThatTellNothing) {
  Random random(4);
  const Lens lens = {image_center(kSize)};
  ZoomingOptions known;
  known.square = known.centered = true;
  // Head-on: without noise by the closed form, with noise by its sigma.
  for (const double noise : {0.0, 0.1}) {
    auto views = views_of(lens, 3, noise, random);
    const SE3 head_on = {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 0.4}};
    views[1] = scenes::observe(lens.at(0), kBoard, head_on, noise, random);
    EXPECT_NE(refusal(views, known).find("iew 1"), std::string::npos) << refusal(views, known);
    EXPECT_NE(refusal(views, known).find("ilt it"), std::string::npos) << refusal(views, known);
  }
  EXPECT_NE(refusal(views_of(lens, 2, 0, random), {}).find("takes 3 views"), std::string::npos);
  EXPECT_NE(refusal({}, {}).find("no view"), std::string::npos);
  // All tilted about one axis: the principal point along it stays open.
  std::vector<View> one_axis;
  for (const double tilt : {0.4, 0.6, 0.8, -0.5}) {
    const Eigen::Matrix3d turn = exp_so3({0, tilt, 0});
    const SE3 pose = {turn, Eigen::Vector3d(0, 0, 0.5) - turn * Eigen::Vector3d(0.1, 0.0625, 0)};
    one_axis.push_back(scenes::observe(lens.at(0), kBoard, pose, 0, random));
  }
  EXPECT_NE(refusal(one_axis, {}).find("--fix"), std::string::npos) << refusal(one_axis, {});
  View broken = one_axis.front();
  broken.observation.ids[0] = 999;
  EXPECT_NE(refusal({broken}, known), "");
}

}  // namespace
}  // namespace calvin
