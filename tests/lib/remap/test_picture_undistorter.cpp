// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// PictureUndistorter: the pixels of a whole picture, and the points that follow them.
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/remap/picture_undistorter.hpp"

namespace calvin {
namespace {

constexpr ImageSize kSize = {320, 240};

Camera barrel() {
  return Camera::make("brown4", kSize, {240, 239, 163, 118, -0.28, 0.09, 5e-4, -7e-4}).value();
}

// A scene of waves, a function of the ray alone, in grey levels of one channel.
double wave(const Eigen::Vector3d& ray, int channel) {
  return 128 + 60 * std::sin(9 * ray.x() / ray.z() + channel) * std::cos(7 * ray.y() / ray.z());
}

// The scene as a camera sees it.
std::vector<std::uint8_t> picture_of(const Camera& camera, int channels) {
  const auto [width, height] = camera.image_size();
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto ray = camera.unproject({double(u), double(v)}).value();
      for (int c = 0; c < channels; ++c) {
        pixels.push_back(static_cast<std::uint8_t>(std::lround(wave(ray, c))));
      }
    }
  }
  return pixels;
}

TEST(PictureUndistorter, ShowsWhatAPinholeWouldSee) {
  for (int channels = 1; channels <= 4; ++channels) {
    const PictureOptions options = {.output = {200, 150}, .channels = channels};
    const auto undistorter = PictureUndistorter::make(barrel(), options);
    ASSERT_TRUE(undistorter.has_value()) << undistorter.error().message;
    EXPECT_EQ(undistorter->output().model(), "pinhole");
    EXPECT_EQ(undistorter->output().image_size(), options.output);
    const auto distorted = picture_of(barrel(), channels);
    std::vector<std::uint8_t> output(200u * 150u * static_cast<unsigned>(channels));
    undistorter->apply(distorted.data(), kSize.width * channels, output.data(), 200 * channels);
    const auto expected = picture_of(undistorter->output(), channels);
    for (std::size_t i = 0; i < output.size(); ++i) {
      ASSERT_NEAR(output[i], expected[i], 2) << "byte " << i << " of " << channels << " channels";
    }
  }
}

TEST(PictureUndistorter, PointsFollowTheRays) {
  const auto undistorter = PictureUndistorter::make(barrel()).value();
  const auto copy = undistorter;  // shares the map
  for (const Pixel at : {Pixel{30, 40}, Pixel{160, 120}, Pixel{250.5, 199.25}}) {
    const auto source = copy.to_source(at);
    ASSERT_TRUE(source.has_value());
    const auto expected = barrel().project(copy.output().unproject(at).value());
    EXPECT_NEAR(source->u, expected->u, 1e-9);
    EXPECT_NEAR(source->v, expected->v, 1e-9);
    const auto back = undistorter.to_output(*source);
    ASSERT_TRUE(back.has_value());
    EXPECT_NEAR(back->u, at.u, 1e-7);
    EXPECT_NEAR(back->v, at.v, 1e-7);
  }
  EXPECT_FALSE(undistorter.to_output({0, 0}).has_value());  // cut off by alpha = 0
}

TEST(PictureUndistorter, RefusesWhatNoPictureIs) {
  for (const int channels : {0, -1, 5}) {
    EXPECT_EQ(PictureUndistorter::make(barrel(), {.channels = channels}).error().code,
              ErrorCode::kInvalidArgument);
  }
  for (const double alpha : {std::nan(""), -1.0, 1.001, 2.0, HUGE_VAL}) {
    const auto made = PictureUndistorter::make(barrel(), {.alpha = alpha});
    ASSERT_FALSE(made.has_value()) << alpha;
    EXPECT_EQ(made.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(made.error().message.find("0 to 1"), std::string::npos);
  }
  for (const ImageSize size : {ImageSize{0, 5}, ImageSize{-1, 5}, ImageSize{70000, 5}}) {
    EXPECT_EQ(PictureUndistorter::make(barrel(), {.output = size}).error().code,
              ErrorCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace calvin
