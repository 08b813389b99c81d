// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corner next to a click: where the renderer has put it, of any size, blur and step, and none
// where there is none.
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/nearest/nearest_point.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

constexpr ImageSize kFrame = {1280, 720};

struct Score {
  int clicks = 0;
  int found = 0;
  int near = 0;        // of those found, within .1 px of the corner that was meant
  double squares = 0;  // of their distances, px^2
  double predicted = 0;
};

// Clicks at 1 to 2 px from the true corners of pictures.
Score score(const RenderOptions& options, double scale, int pictures, double reach = 5) {
  Score score;
  scenes::Random random(7);
  const Camera camera = default_camera(kFrame);
  const BoardRenderer renderer(camera);
  const Board board = parse_board("checkerboard:9x6:25mm").value();
  const Motion motion(MotionKind::kRandom, camera, board, 3);
  for (int n = 0; n < pictures; ++n) {
    SE3 pose = motion.camera_from_board(n);
    pose.translation *= scale;
    RenderOptions noisy = options;
    noisy.seed = static_cast<std::uint64_t>(n);
    const GrayImage picture = renderer.render(board, pose, noisy);
    const Observation truth = true_observation(camera, board, pose);
    for (const Pixel& at : truth.uv) {
      if (at.u < 8 || at.v < 8 || at.u > kFrame.width - 9 || at.v > kFrame.height - 9) continue;
      const double angle = scenes::uniform(random, 0, 6.28);
      const double off = scenes::uniform(random, 1, 2);
      const Pixel click = {at.u + off * std::cos(angle), at.v + off * std::sin(angle)};
      ++score.clicks;
      const auto corner = nearest_point(picture.view(), click, reach);
      if (!corner) continue;
      ++score.found;
      const double distance = std::hypot(corner->at.u - at.u, corner->at.v - at.v);
      if (distance > 0.1) continue;
      ++score.near;
      score.squares += distance * distance / 2;
      score.predicted += corner->sigma * corner->sigma;
    }
  }
  return score;
}

TEST(NearestCorner, IsWhereItWasRendered) {
  RenderOptions options;
  options.noise = 2;
  options.blur = 0.7;
  const Score s = score(options, 1, scenes::full_count() ? 60 : 8);
  ASSERT_GT(s.clicks, 300);
  EXPECT_GE(s.near, 0.99 * s.clicks);
  EXPECT_GE(s.near, 0.998 * s.found) << "not another corner, and no bad one";
  const double ratio = std::sqrt(s.squares / s.predicted);
  std::cout << s.clicks << " clicks, " << s.near << " within .1 px, rms "
            << std::sqrt(s.squares / s.near) << " px, real over predicted " << ratio << "\n";
  EXPECT_LT(ratio, 1.6) << "the sigma is no boast";
  EXPECT_GT(ratio, 0.5);
}

TEST(NearestCorner, IsFoundInSmallBoardsAndBlurredOnes) {
  RenderOptions options;
  options.noise = 1;
  options.blur = 0.6;
  const Score small = score(options, 2.5, 6);
  EXPECT_GE(small.near, 0.97 * small.clicks) << small.clicks;
  options.blur = 3;
  const Score blurred = score(options, 0.8, 4);
  EXPECT_GE(blurred.near, 0.95 * blurred.clicks) << blurred.clicks;
  std::cout << "small " << small.near << " of " << small.clicks << ", blurred " << blurred.near
            << " of " << blurred.clicks << "\n";
}

// A picture of which every second byte is a pixel, as the luma of YUY2.
TEST(NearestCorner, IsTheSameInPicturesOfAnyStep) {
  const Camera camera = default_camera(kFrame);
  const Board board = parse_board("checkerboard:9x6:25mm").value();
  const SE3 pose = Motion(MotionKind::kRandom, camera, board, 3).camera_from_board(1);
  const GrayImage picture = render_board(camera, board, pose, {.noise = 1, .blur = 0.7});
  std::vector<std::uint8_t> pairs(2 * picture.pixels.size(), 128);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) pairs[2 * i] = picture.pixels[i];
  const ImageView stepped = {pairs.data(), picture.width, picture.height, 2 * picture.width, 2};
  const Pixel at = true_observation(camera, board, pose).uv.at(20);
  const auto plain = nearest_point(picture.view(), {at.u + 1, at.v - 1}, 5);
  const auto other = nearest_point(stepped, {at.u + 1, at.v - 1}, 5);
  ASSERT_TRUE(plain && other);
  EXPECT_EQ(plain->at.u, other->at.u);
  EXPECT_EQ(plain->at.v, other->at.v);
}

TEST(NearestCorner, IsAbsentWhereThereIsNone) {
  GrayImage picture(200, 150, 90);
  EXPECT_FALSE(nearest_point(picture.view(), {100, 75}, 20)) << "plain grey";
  for (int y = 0; y < 150; ++y) {
    for (int x = 100; x < 200; ++x) picture.row(y)[x] = 200;
  }
  EXPECT_FALSE(nearest_point(picture.view(), {100, 75}, 20)) << "one edge";
  for (int y = 75; y < 150; ++y) {
    for (int x = 100; x < 200; ++x) picture.row(y)[x] = 90;
  }
  EXPECT_FALSE(nearest_point(picture.view(), {100, 75}, 20)) << "one corner of one square";
  for (int y = 75; y < 150; ++y) {
    for (int x = 0; x < 100; ++x) picture.row(y)[x] = 200;
  }
  const auto corner = nearest_point(picture.view(), {102, 77}, 20);
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->at.u, 99.5, 0.02);
  EXPECT_NEAR(corner->at.v, 74.5, 0.02);
  EXPECT_FALSE(nearest_point(picture.view(), {102, 77}, 2)) << "beyond the reach";

  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kFar = std::numeric_limits<double>::infinity();
  for (const Pixel at : {Pixel{kNone, 3}, Pixel{3, kNone}, Pixel{kFar, 3}, Pixel{-1e9, 3},
                         Pixel{1e300, 1e300}, Pixel{-4, -4}, Pixel{203, 152}}) {
    EXPECT_FALSE(nearest_point(picture.view(), at, 5));
  }
  EXPECT_FALSE(nearest_point(picture.view(), {100, 75}, kNone));
  EXPECT_FALSE(nearest_point(ImageView{}, {0, 0}, 5));
  const GrayImage tiny(3, 2, 1);
  EXPECT_FALSE(nearest_point(tiny.view(), {1, 1}, 5));
}

}  // namespace
}  // namespace calvin
