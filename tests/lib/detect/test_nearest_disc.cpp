// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The disc next to a click: where the renderer has put its centre, dark or light, of any size and
// blur, and none where there is none.
#include <cmath>
#include <cstdint>
#include <string>

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
  double squares = 0;    // of the distances of those found, px^2
  double predicted = 0;  // likewise, of their sigmas
};

struct Scene {
  std::string board = "circles:7x5:30mm";
  RenderOptions options;
  double distance = 1;  // of that at which the board fills most of the picture
  bool is_negative = false;
};

// Clicks at 1 to 2 px from the true centres of pictures.
Score score(const Scene& scene, int pictures) {
  Score score;
  scenes::Random random(7);
  const Camera camera = default_camera(kFrame);
  const BoardRenderer renderer(camera);
  const Board board = parse_board(scene.board).value();
  const Motion motion(MotionKind::kRandom, camera, board, 3);
  for (int n = 0; n < pictures; ++n) {
    SE3 pose = motion.camera_from_board(n);
    pose.translation *= scene.distance;
    RenderOptions noisy = scene.options;
    noisy.seed = static_cast<std::uint64_t>(n);
    GrayImage picture = renderer.render(board, pose, noisy);
    if (scene.is_negative) {
      for (std::uint8_t& grey : picture.pixels) grey = static_cast<std::uint8_t>(255 - grey);
    }
    const Observation truth = true_observation(camera, board, pose);
    for (const Pixel& at : truth.uv) {
      const double inside = 40 / std::min(scene.distance, 1.0);  // px: whole discs
      if (at.u < inside || at.v < inside || at.u > kFrame.width - inside ||
          at.v > kFrame.height - inside) {
        continue;
      }
      const double angle = scenes::uniform(random, 0, 6.28);
      const double off = scenes::uniform(random, 1, 2);
      ++score.clicks;
      const auto disc = nearest_point(
          picture.view(), {at.u + off * std::cos(angle), at.v + off * std::sin(angle)}, 5);
      if (!disc || disc->kind != FoundPoint::Kind::kDisc) continue;
      const double distance = std::hypot(disc->at.u - at.u, disc->at.v - at.v);
      ++score.found;
      score.squares += distance * distance / 2;
      score.predicted += disc->sigma * disc->sigma;
    }
  }
  return score;
}

struct Case {
  const char* name;
  Scene scene;
};

class NearestDisc : public testing::TestWithParam<Case> {};

TEST_P(NearestDisc, IsWhereItWasRendered) {
  const Score s = score(GetParam().scene, scenes::full_count() ? 40 : 8);
  const double ratio = std::sqrt(s.squares / s.predicted);
  std::cout << s.clicks << " clicks, " << s.found << " found, rms "
            << std::sqrt(s.squares / s.found) << " px, real over predicted " << ratio << "\n";
  ASSERT_GT(s.clicks, 100);
  EXPECT_GE(s.found, 0.97 * s.clicks);
  EXPECT_LT(ratio, 1.6) << "the sigma is no boast";
  EXPECT_GT(ratio, 0.2);
}

INSTANTIATE_TEST_SUITE_P(
    , NearestDisc,
    testing::Values(Case{"dark", {"circles:7x5:30mm", {.noise = 2, .blur = 0.7}}},
                    Case{"light", {"circles:7x5:30mm", {.noise = 2, .blur = 0.7}, 1, true}},
                    Case{"far", {"circles:7x5:30mm", {.noise = 1, .blur = 0.6}, 3}},
                    Case{"large", {"circles:7x5:30mm", {.noise = 2, .blur = 0.7}, 0.45}},
                    Case{"blurred", {"circles:7x5:30mm", {.noise = 1, .blur = 3}}},
                    Case{"asymmetric", {"acircles:4x11:20mm", {.noise = 2, .blur = 0.7}}}),
    [](const auto& one) { return std::string(one.param.name); });

GrayImage painted(int width, int height, auto&& is_dark) {
  GrayImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) picture.row(y)[x] = is_dark(x, y) ? 40 : 200;
  }
  return picture;
}

TEST(NearestPoint, IsNoDiscWhereThereIsNone) {
  const auto square =
      painted(200, 150, [](int x, int y) { return std::abs(x - 100) < 8 && std::abs(y - 75) < 8; });
  EXPECT_FALSE(nearest_point(square.view(), {101, 76}, 5)) << "a square";
  const auto bar = painted(200, 150, [](int x, int y) { return x > 40 && std::abs(y - 75) < 4; });
  EXPECT_FALSE(nearest_point(bar.view(), {101, 76}, 5)) << "a bar";
  const auto half =
      painted(200, 150, [](int x, int y) { return x > 100 && std::hypot(x - 100, y - 75) < 12; });
  EXPECT_FALSE(nearest_point(half.view(), {101, 76}, 5)) << "half a disc";
  const auto disc =
      painted(200, 150, [](int x, int y) { return std::hypot(x - 100, y - 75) < 12; });
  ASSERT_TRUE(nearest_point(disc.view(), {102, 76}, 5));
  EXPECT_FALSE(nearest_point(disc.view(), {108, 80}, 5)) << "beyond the reach";
}

}  // namespace
}  // namespace calvin
