// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is said of the noise of an image, and what smoothing does to it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/core/image.hpp"
#include "calvin/detect/smoothing.hpp"

namespace calvin {
namespace {

constexpr int kWidth = 333;  // no multiple of a vector
constexpr int kHeight = 217;

// Squares of 24 px, and noise.
GrayImage squares_in_noise(double noise) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0, 1);
  GrayImage image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double grey = ((x / 24 + y / 24) % 2 == 0 ? 80 : 160) + noise * normal(random);
      image.row(y)[x] = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
    }
  }
  return image;
}

TEST(Smoothing, TellsTheNoiseBetweenEdges) {
  EXPECT_LT(detect::noise_of(squares_in_noise(0).view()), 0.5F);
  for (const double noise : {4.0, 8.0, 16.0}) {
    EXPECT_NEAR(detect::noise_of(squares_in_noise(noise).view()), noise, 0.2 * noise) << noise;
  }
}

TEST(Smoothing, IsABinomialOfFiveByFive) {
  constexpr int kWeights[] = {1, 4, 6, 4, 1};
  const GrayImage image = squares_in_noise(10);
  std::vector<std::uint8_t> pixels;
  std::vector<std::uint16_t> sums;
  const ImageView smooth = detect::smoothed(image.view(), pixels, sums);
  ASSERT_EQ(smooth.width, kWidth);
  ASSERT_EQ(smooth.height, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      int sum = 0;
      for (int k = 0; k < 25; ++k) {
        const int u = std::clamp(x + k % 5 - 2, 0, kWidth - 1);
        const int v = std::clamp(y + k / 5 - 2, 0, kHeight - 1);
        sum += kWeights[k % 5] * kWeights[k / 5] * image.view().data[v * image.view().stride + u];
      }
      // Rounded once, to the nearest.
      ASSERT_NEAR(smooth.data[y * smooth.stride + x], sum / 256.0, 0.5) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace calvin
