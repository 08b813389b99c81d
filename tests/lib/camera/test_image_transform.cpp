// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures that are scaled, cut and turned pixel by pixel say where their pixels went.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/camera/image_transform.hpp"

namespace calvin {
namespace {

// The mean place of the pixels of a picture that become one pixel, when each `columns` x `rows` of
// them do, from pixel (x, y) on.
Pixel middle_of(int column, int row, int columns, int rows, int x, int y) {
  Pixel sum;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      sum.u += x + columns * column + i;
      sum.v += y + rows * row + j;
    }
  }
  return {sum.u / (columns * rows), sum.v / (columns * rows)};
}

void expect_near(Pixel found, Pixel expected) {
  EXPECT_NEAR(found.u, expected.u, 1e-9);
  EXPECT_NEAR(found.v, expected.v, 1e-9);
}

TEST(ImageTransform, ScalingIsTheMeanOfPixels) {
  const auto whole = ImageTransform::scaled({640, 480}, {160, 240});
  const auto part = ImageTransform::filled({16, 6, 320, 240}, {80, 120});
  EXPECT_EQ(whole.size(), (ImageSize{160, 240}));
  EXPECT_EQ(part.size(), (ImageSize{80, 120}));
  for (const int at : {0, 7, 79}) {
    const Pixel pixel = {1.0 * at, at + 0.0};
    expect_near(whole(middle_of(at, at, 4, 2, 0, 0)), pixel);
    expect_near(part(middle_of(at, at, 4, 2, 16, 6)), pixel);
  }
  // Larger pictures are the inverse.
  const auto back = ImageTransform::scaled({160, 240}, {640, 480});
  expect_near(back(whole({123.4, 56.7})), {123.4, 56.7});
  // The outer edge stays the outer edge.
  expect_near(whole({-0.5, -0.5}), {-0.5, -0.5});
  expect_near(whole({639.5, 479.5}), {159.5, 239.5});
}

TEST(ImageTransform, CroppingTakesThePartsCornerOff) {
  const auto crop = ImageTransform::cropped(100, 50, {300, 200});
  EXPECT_EQ(crop.size(), (ImageSize{300, 200}));
  expect_near(crop({100, 50}), {0, 0});
  expect_near(crop({99.25, 350.5}), {-0.75, 300.5});
}

TEST(ImageTransform, SharesOfAPictureAreItsCells) {
  // Cells of 10 px: the first one has the pixels 0 to 9.
  EXPECT_EQ(coordinate_at(0, 640), -0.5);
  EXPECT_EQ(coordinate_at(1, 640), 639.5);
  EXPECT_NEAR(coordinate_at(0.5 / 64, 640), 4.5, 1e-12);
  for (const double c : {-0.5, 0.0, 9.0, 639.5}) {
    EXPECT_NEAR(coordinate_at(share_before(c, 640), 640), c, 1e-12);
  }
  EXPECT_LT(share_before(9, 640), 1.0 / 64);
  EXPECT_GT(share_before(10, 640), 1.0 / 64);
}

// A camera that is moved sees each point where its pixel was moved to.
TEST(ImageTransform, MovesCamerasAsTheirPixels) {
  const Camera camera = Camera::make("tilted14", {640, 480},
                                     {520, 510, 325, 236, -0.2, 0.05, 2e-3, -1e-3, 0.01, 0, 0, 0,
                                      1e-3, -2e-3, 2e-3, 1e-3, 0.05, 0})
                            .value();
  const Rectangle part = {101.5, 33.25, 400, 300};
  std::vector<ImageTransform> transforms = {ImageTransform::scaled({640, 480}, {320, 480}),
                                            ImageTransform::cropped(17, 91, {300, 200}),
                                            ImageTransform::filled(part, {200, 600})};
  for (int i = 0; i < 8; ++i) {
    transforms.push_back(
        ImageTransform::turned({640, 480}, {(i & 1) != 0, (i & 2) != 0, (i & 4) != 0}));
  }
  const Eigen::Vector3d point(0.2, -0.15, 1);
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    SCOPED_TRACE(i);
    Eigen::Vector3d seen = point;
    if (i >= 3) {
      const std::size_t turn = i - 3;
      if ((turn & 1) != 0) std::swap(seen[0], seen[1]);
      if ((turn & 2) != 0) seen[0] = -seen[0];
      if ((turn & 4) != 0) seen[1] = -seen[1];
    }
    const Camera moved = transforms[i](camera).value();
    EXPECT_EQ(moved.image_size(), transforms[i].size());
    expect_near(moved.project(seen).value(), transforms[i](camera.project(point).value()));
  }
}

// The largest centre that a camera may have, before and after a cut that makes it larger.
TEST(ImageTransform, WhatNoCameraCanHaveIsAnError) {
  const Camera camera = Camera::make("pinhole", {640, 480}, {500, 500, -1e12, 239.5}).value();
  EXPECT_FALSE(ImageTransform::cropped(10, 0, {320, 240})(camera).has_value());
  EXPECT_FALSE(fit_to_part(camera.to_calibration(), {{640, 480}, 10, 0, {320, 240}}).has_value());
  EXPECT_EQ(camera.cropped(10, 0, {320, 240}).parameters(), camera.parameters());
  EXPECT_EQ(camera.scaled({0, 0}).image_size(), camera.image_size());
}

TEST(ImageTransform, MovesObservations) {
  Observation seen;
  seen.image_size = {640, 480};
  seen.ids = {3, 4};
  seen.uv = {{0.5, 0.5}, {639.5, 1}};
  seen.sigma = {0.1, 0.2};
  seen.blur = 1.5;
  seen.patches = std::make_shared<CornerPatches>();
  const Observation moved = ImageTransform::scaled({640, 480}, {320, 120})(seen);
  EXPECT_EQ(moved.image_size, (ImageSize{320, 120}));
  EXPECT_EQ(moved.ids, seen.ids);
  expect_near(moved.uv[0], {0, -0.25});
  expect_near(moved.uv[1], {319.5, -0.125});
  // Half as wide, a quarter as high.
  EXPECT_NEAR(moved.sigma[1], 0.2 * 0.375, 1e-12);
  EXPECT_NEAR(moved.blur, 1.5 * 0.375, 1e-12);
  EXPECT_EQ(moved.patches, nullptr);
}

// Cameras that are drawn from a covariance and moved scatter as the moved covariance says.
TEST(ImageTransform, CovarianceIsThatOfMovedCameras) {
  const std::vector<std::string_view> names = {"fx", "fy", "cx", "cy", "k1", "skew"};
  const std::vector<double> mean = {500, 510, 320, 240, -0.1, 1};
  const Eigen::Index n = 6;
  const Eigen::MatrixXd root =
      Eigen::MatrixXd::NullaryExpr(n, n, [](Eigen::Index i, Eigen::Index j) {
        return (i == 4 ? 1e-3 : 1) * std::sin(1.0 + static_cast<double>(3 * i + 7 * j));
      });
  const auto transform = ImageTransform::scaled({640, 480}, {960, 120});
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 20000;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  const auto moved = [&](const Eigen::VectorXd& d) {
    const Camera camera = Camera::make("brown5", {640, 480},
                                       {mean[0] + d[0], mean[1] + d[1], mean[2] + d[2],
                                        mean[3] + d[3], mean[4] + d[4], 0, 0, 0, 0},
                                       mean[5] + d[5])
                              .value();
    const Camera there = transform(camera).value();
    const auto& p = there.parameters();
    return Eigen::VectorXd{{p[0], p[1], p[2], p[3], p[4], there.skew()}};
  };
  const Eigen::VectorXd middle = moved(Eigen::VectorXd::Zero(n));
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd draw =
        root * Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index) { return normal(random); });
    const Eigen::VectorXd off = moved(draw) - middle;
    sum += off * off.transpose();
  }
  const Eigen::MatrixXd expected =
      scaled_covariance(root * root.transpose(), names, 960.0 / 640, 120.0 / 480);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double size = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(sum(i, j) / kDraws, expected(i, j), 0.05 * size) << i << ", " << j;
    }
  }
}

}  // namespace
}  // namespace calvin
