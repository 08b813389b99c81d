// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How much of its picture a camera can be used for: formulas for the simplest ones, silence for
// every lens that people have, a word for numbers that nobody means.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "calvin/camera/usable_area.hpp"
#include "calvin/io/settings.hpp"
#include "lens_samples.hpp"

namespace calvin {
namespace {

Camera camera_of(const std::string& text) {
  return Camera::make(*parse_calibration_setting(text + ",cx=319.5,cy=239.5,width=640,height=480"))
      .value();
}

// A pixel of a pinhole sees a solid angle as the third power of the cosine to the axis.
double of_a_pinhole(double f) {
  double sum = 0;
  double squares = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const double w =
          std::pow(1 + ((u - 319.5) * (u - 319.5) + (v - 239.5) * (v - 239.5)) / (f * f), -1.5);
      sum += w;
      squares += w * w;
    }
  }
  return sum * sum / (640 * 480 * squares);
}

TEST(UsableArea, OfAPinhole) {
  // Cells of 20 px are coarse where the view is wide.
  for (const double f : {150.0, 300.0, 500.0, 5000.0}) {
    const std::string focal = std::to_string(f);
    const Camera camera = camera_of("fx=" + focal + ",fy=" + focal);
    EXPECT_NEAR(usable_area(camera), of_a_pinhole(f), 0.01) << f;
  }
}

// r (1 + k1 r^2) folds back where 1 + 3 k1 r^2 = 0: what lies outside of that circle counts for
// nothing, and within it the pixels see ever more towards the rim. Cells that the circle cuts, of
// 20 px, count for nothing too.
TEST(UsableArea, OfALensThatFoldsBack) {
  for (const double k1 : {-0.3, -0.5, -1.0}) {
    const double r = std::sqrt(-1 / (3 * k1));
    const double radius = 320 * r * (1 + k1 * r * r);
    const double circle = std::numbers::pi * radius * radius / (640 * 480);
    const double area = usable_area(camera_of("fx=320,fy=320,k1=" + std::to_string(k1)));
    EXPECT_LT(area, circle) << k1;
    EXPECT_GT(area, 0.6 * circle) << k1;
  }
}

// A board is shown up to 85 degrees from the axis, a picture may be round, and what a model says of
// places that it folds back from is no reason to leave them out.
TEST(UsableArea, KnowsWhereABoardCanBeShown) {
  const auto round = Camera::make("fisheye", {1920, 1080}, {326, 326, 960, 540, 0, 0, 0, 0});
  const double radius = 326 * 85.0 / 180 * std::numbers::pi;
  EXPECT_NEAR(visible_area(*round), std::numbers::pi * radius * radius, 1e-3 * radius * radius);
  const auto wide = Camera::make("fisheye", {1920, 1080}, {650, 650, 960, 540, 0, 0, 0, 0});
  EXPECT_LT(visible_area(*wide), 0.97 * 1920 * 1080) << "its corners are 97 degrees from the axis";
  EXPECT_GT(visible_area(*wide), 0.93 * 1920 * 1080);
  for (const char* text : {"fx=500,fy=500", "fx=500,fy=500,k1=-0.3", "fx=500,fy=480,k1=0.1"}) {
    EXPECT_NEAR(visible_area(camera_of(text)), 640 * 480, 0.005 * 640 * 480) << text;
  }
  const auto folds = Camera::make("fisheye", {640, 480}, {300, 300, 320, 240, -0.2, 0, 0, 0});
  ASSERT_TRUE(folds) << folds.error().message;
  EXPECT_FALSE(folds->unproject({10, 240})) << "nothing of the model is there";
  EXPECT_NEAR(visible_area(*folds), 640 * 480, 0.005 * 640 * 480);
}

TEST(UsableArea, EveryLensIsSilent) {
  for (const std::string_view model : model_names()) {
    const auto& samples = samples::lens(model);
    const bool wide = samples.widest > 1.5;
    for (const auto& lens : samples.coefficients) {
      const double f = wide ? 190 : 400;
      std::vector<double> parameters = {f, f, 325, 236};
      parameters.insert(parameters.end(), lens.begin(), lens.end());
      const auto camera = Camera::make(model, {640, 480}, parameters);
      ASSERT_TRUE(camera) << model;
      EXPECT_GT(usable_area(*camera), 0.3) << model;
      EXPECT_TRUE(check_usable_area(*camera)) << model;
    }
  }
  // The round picture of a fisheye of 190 degrees, as high as frames of 16:9.
  const auto round = Camera::make("fisheye", {1920, 1080}, {326, 326, 960, 540, 0, 0, 0, 0});
  EXPECT_TRUE(check_usable_area(*round));
}

TEST(UsableArea, WhatNobodyMeansIsSaid) {
  for (const char* text :
       {"fx=500,fy=500,k1=-1e6", "fx=500,fy=500,k1=1e6", "fx=1e-3,fy=1e-3", "fx=1e-3,fy=500",
        "fx=1,fy=1", "fx=1e-3,fy=1e-3,model=fisheye", "fx=1e-3,fy=1e-3,alpha=0.3,model=ucm"}) {
    const Status usable = check_usable_area(camera_of(text));
    ASSERT_FALSE(usable) << text;
    EXPECT_NE(usable.error().message.find("% of its picture of 640x480"), std::string::npos);
  }
}

}  // namespace
}  // namespace calvin
