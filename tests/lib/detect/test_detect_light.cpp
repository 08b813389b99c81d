// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A light that is rendered before lamps and noise: found, where it is, and how well that is known.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "light_video.hpp"

namespace calvin {
namespace {

using scenes::LightVideo;

struct Kind {
  const char* name;
  double glow;   // grey levels
  double blur;   // px
  double noise;  // grey levels
  double dark;   // grey levels, of the room
  int lamps;
  double distance;  // times that of the motion
};
constexpr Kind kKinds[] = {
    {"cut off", 2000, 0.8, 2, 20, 0, 1}, {"far cut off", 6000, 0.8, 2, 20, 0, 1},
    {"whole", 180, 0.8, 2, 20, 0, 1},    {"dim", 90, 0.8, 2, 60, 0, 1},
    {"noise 6", 600, 0.8, 6, 20, 0, 1},  {"tiny", 1000, 0.6, 2, 20, 0, 3},
    {"blurred", 900, 2.5, 2, 20, 0, 1},  {"near", 900, 0.8, 2, 20, 0, 0.4},
    {"lamps", 2000, 0.8, 2, 20, 12, 1},  {"lit room", 1500, 0.8, 3, 120, 6, 1},
};

class LightAccuracy : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, LightAccuracy, ::testing::ValuesIn(kKinds), [](const auto& test) {
  std::string name = test.param.name;
  std::erase(name, ' ');
  return name;
});

TEST_P(LightAccuracy, IsWhatItsSigmaSays) {
  const Kind& kind = GetParam();
  LightVideo video({1280, 720}, {.noise = kind.noise,
                                 .blur = kind.blur,
                                 .dark = kind.dark,
                                 .glow = kind.glow,
                                 .lamps = kind.lamps});
  const Motion motion(MotionKind::kRandom, video.camera(), LightVideo::light(), 4);
  const int frames = scenes::full_count() ? 1000 : 120;
  double square = 0;
  double normalised = 0;
  double farthest = 0;
  double sum_u = 0;
  int found = 0;
  int visible = 0;
  video.look_at_the_room(3);
  for (int i = 0; i < frames; ++i) {
    const Eigen::Vector3d at = kind.distance * motion.camera_from_board(i).translation;
    const Detection seen = video.look(at);
    const Pixel truth = video.camera().project(at).value();
    if (video.is_before_a_lamp(truth)) continue;
    ++visible;
    if (!seen.observation.found()) continue;
    ++found;
    const double u = seen.observation.uv[0].u - truth.u;
    const double v = seen.observation.uv[0].v - truth.v;
    const double sigma = seen.observation.sigma[0];
    square += (u * u + v * v) / 2;
    normalised += (u * u + v * v) / 2 / (sigma * sigma);
    sum_u += u;
    farthest = std::max(farthest, std::hypot(u, v) / sigma);
  }
  const double ratio = std::sqrt(normalised / found);
  std::cout << "  " << found << " of " << visible << ", error " << std::sqrt(square / found)
            << " px per coordinate, real over predicted " << ratio << ", at most " << farthest
            << " sigma, mean " << sum_u / found << '\n';
  EXPECT_GE(found, visible * 98 / 100);
  EXPECT_GT(visible, frames / 2);
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.2);
  EXPECT_LT(farthest, 5.5);
  EXPECT_LT(std::sqrt(square / found), 0.15);
  EXPECT_NEAR(sum_u / found, 0, 4 * std::sqrt(square) / found + 1e-3);
}

// What is no Gaussian at all has its middle where a Gaussian has it, and a sigma that is not too
// small.
TEST(Light, MayBeADiscOfEvenBrightness) {
  for (const double glow : {150.0, 600.0, 5000.0}) {
    LightVideo video({640, 480}, {.noise = 2, .blur = 0.8, .dark = 20, .glow = glow});
    const Motion motion(MotionKind::kRandom, video.camera(), LightVideo::light(), 6);
    video.look_at_the_room(3);
    double square = 0;
    double normalised = 0;
    int found = 0;
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d at = motion.camera_from_board(i).translation;
      const Detection seen = video.look_at_disc(at, 0.02);
      if (!seen.observation.found()) continue;
      ++found;
      const Pixel truth = video.camera().project(at).value();
      const double off =
          std::hypot(seen.observation.uv[0].u - truth.u, seen.observation.uv[0].v - truth.v) /
          std::sqrt(2.0);
      square += off * off;
      normalised += std::pow(off / seen.observation.sigma[0], 2);
    }
    std::cout << "  glow " << glow << ": " << found << " of 40, error " << std::sqrt(square / found)
              << " px, real over predicted " << std::sqrt(normalised / found) << '\n';
    EXPECT_GE(found, 39) << glow;
    EXPECT_LT(std::sqrt(normalised / found), 1.2) << glow;
  }
}

// A shutter that is open while the light moves.
TEST(Light, ThatLeavesAStreakIsItsMiddleOrTooFast) {
  for (const double length : {4.0, 8.0, 16.0, 150.0}) {
    LightVideo video({1280, 720}, {.noise = 2, .blur = 0.8, .dark = 20, .glow = 1200});
    video.look_at_the_room(2);
    scenes::Random random(9);
    int found = 0;
    double farthest = 0;
    for (int i = 0; i < 30; ++i) {
      const Pixel middle = {scenes::uniform(random, 200, 1080), scenes::uniform(random, 200, 500)};
      const double angle = scenes::uniform(random, 0, 3.1);
      const Detection seen =
          video.look_at_streak(middle, {length * std::cos(angle), length * std::sin(angle)});
      if (!seen.observation.found()) {
        EXPECT_EQ(seen.reason, Reason::kMoving) << length;
        EXPECT_NE(seen.obstacle.find("too fast"), std::string::npos);
        continue;
      }
      ++found;
      const Pixel at = seen.observation.uv[0];
      farthest = std::max(farthest,
                          std::hypot(at.u - middle.u, at.v - middle.v) / seen.observation.sigma[0]);
      if (length >= 8) {
        EXPECT_GT(seen.observation.sigma[0], 0.02 * length);
      }
    }
    EXPECT_EQ(found, length < 100 ? 30 : 0) << length;
    EXPECT_LT(farthest, 4) << length;
  }
}

// The middle of a picture that is alone, which lamps would spoil.
TEST(Light, IsFoundInADarkPictureWithoutAnyBefore) {
  LightVideo video({1280, 720}, {.noise = 2, .blur = 0.8, .dark = 15, .glow = 1500});
  const Motion motion(MotionKind::kRandom, video.camera(), LightVideo::light(), 5);
  const auto detector = make_detector(LightVideo::light()).value();
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d at = motion.camera_from_board(i).translation;
    const GrayImage image = video.picture({at});
    const Observation seen = detector->detect(image.view()).observation;
    ASSERT_TRUE(seen.found()) << i;
    const Pixel truth = video.camera().project(at).value();
    EXPECT_NEAR(seen.uv[0].u, truth.u, 5 * seen.sigma[0]);
    EXPECT_NEAR(seen.uv[0].v, truth.v, 5 * seen.sigma[0]);
    EXPECT_EQ(seen.board, "dot");
    EXPECT_EQ(seen.image_size, (ImageSize{1280, 720}));
    const GrayImage two = video.picture({at, motion.camera_from_board(i + 100).translation});
    EXPECT_FALSE(detector->detect(two.view()).observation.found()) << "which one?";
  }
}

}  // namespace
}  // namespace calvin
