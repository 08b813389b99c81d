// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What lens and sensor add to a rendered picture: noise, blur, exposure.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {
namespace {

Checkerboard board(const char* text = "checkerboard:9x6:25mm") {
  return *parse_board(text).value().as<Checkerboard>();
}

Camera pinhole(double cx) {
  return Camera::make("pinhole", {640, 480}, {500, 500, cx, 240}).value();
}

TEST(NoiseSeed, IsAnotherForEachFrameAndSequence) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t sequence = 0; sequence < 20; ++sequence) {
    for (std::uint64_t frame = 0; frame < 20; ++frame) seeds.insert(noise_seed(sequence, frame));
  }
  EXPECT_EQ(seeds.size(), 400U);
}

TEST(Sensor, AddsGaussianNoise) {
  const Camera cam = default_camera({640, 480});
  const BoardRenderer renderer(cam);
  const SE3 away = {Eigen::Matrix3d::Identity(), {0, 0, -1}};
  for (const double sigma : {1.0, 2.0, 8.0}) {
    const GrayImage image = renderer.render(board(), away, {.noise = sigma, .seed = 7});
    const auto n = static_cast<double>(image.pixels.size());
    double mean = 0, square = 0, fourth = 0, right = 0, below = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const double x = image.pixels[i] - 128.0;
      mean += x / n;
      square += x * x / n;
      fourth += x * x * x * x / n;
      if (i > 0) right += x * (image.pixels[i - 1] - 128.0) / n;
      if (i >= 640) below += x * (image.pixels[i - 640] - 128.0) / n;
    }
    const double variance = sigma * sigma + 1.0 / 12;  // of the rounding
    EXPECT_NEAR(mean, 0, 5 * sigma / std::sqrt(n));
    EXPECT_NEAR(square / variance, 1, 5 * std::sqrt(2 / n));
    EXPECT_NEAR(fourth / (square * square), 3, 0.06);
    EXPECT_NEAR(right / variance, 0, 5 / std::sqrt(n));
    EXPECT_NEAR(below / variance, 0, 5 / std::sqrt(n));
    EXPECT_EQ(image.pixels, renderer.render(board(), away, {.noise = sigma, .seed = 7}).pixels);
    EXPECT_NE(image.pixels, renderer.render(board(), away, {.noise = sigma, .seed = 8}).pixels);
  }
}

TEST(Sensor, BlursByTheSigmaAskedFor) {
  // An edge on the border of two pixels: the differences along a row are the blur's own kernel.
  const Camera cam = pinhole(319.5);
  const SE3 pose = {Eigen::Matrix3d::Identity(), {0, -0.1, 0.5}};
  const Checkerboard b = board("checkerboard:9x6:60mm");
  for (const double sigma : {0.3, 0.7, 1.5, 3.0}) {
    const GrayImage image = render_board(cam, b, pose, {.blur = sigma, .dark = 0, .light = 255});
    double sum = 0, first = 0, second = 0, fourth = 0;
    for (int u = 295; u < 345; ++u) {
      const double step = image.view().at(u, 150) - image.view().at(u - 1, 150);
      sum += step;
      first += step * (u - 0.5);
      second += step * (u - 0.5) * (u - 0.5);
      fourth += step * std::pow(u - 320, 4);
    }
    EXPECT_NEAR(first / sum, 319.5, 0.01);
    EXPECT_NEAR(second / sum - std::pow(first / sum, 2), sigma * sigma, 0.015 + 0.03 * sigma);
    // A Gaussian's tails: others bend and sharpen edges as no optics do.
    if (sigma > 0.6) {
      EXPECT_NEAR(fourth / sum / std::pow(sigma, 4), 3, 0.5) << sigma;
    }
  }
}

TEST(Sensor, ExposureScalesAndClips) {
  const Camera cam = pinhole(320);
  const SE3 pose = {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 0.5}};
  const GrayImage image = render_board(cam, board(), pose, {.exposure = 1.5});
  EXPECT_EQ(image.view().at(0, 0), 192);
  std::set<std::uint8_t> values(image.pixels.begin(), image.pixels.end());
  EXPECT_EQ(*values.begin(), 45);
  EXPECT_EQ(*values.rbegin(), 255);
}

}  // namespace
}  // namespace calvin
