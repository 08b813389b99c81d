// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A wand of three lights in a video: each is named by how they lie, however the wand is turned, and
// what may be another one is refused.
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "light_video.hpp"

namespace calvin {
namespace {

using scenes::LightVideo;
using Places = std::vector<Eigen::Vector3d>;

constexpr ImageSize kSize = {1280, 720};
const RenderOptions kOptions = {.noise = 2, .blur = 0.8, .dark = 25, .glow = 1500};
const Board kWand = PointLight{{0, 0.15, 0.5}};

class FollowedWand : public ::testing::Test {
 protected:
  // Where its lights are, m.
  [[nodiscard]] Places at(double number) const {
    const SE3 pose = motion_.camera_from_board(number);
    Places lights;
    for (const Eigen::Vector3d& light : kWand.points()) lights.push_back(pose * light);
    return lights;
  }
  // Those that the camera sees.
  [[nodiscard]] Places seen_of(const Places& lights) const {
    Places seen;
    for (const Eigen::Vector3d& light : lights) {
      const auto p = video_.camera().project(light);
      const bool is_in =
          p && p->u > 3 && p->v > 3 && p->u < kSize.width - 4 && p->v < kSize.height - 4;
      if (is_in) seen.push_back(light);
    }
    return seen;
  }
  // sigmas, of the worst light; more than any picture has where not all were found.
  [[nodiscard]] double error(const Detection& found, const Places& lights) const {
    if (found.observation.ids != std::vector<int>{0, 1, 2}) return 1e6;
    double worst = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Pixel truth = video_.camera().project(lights[k]).value();
      const Pixel uv = found.observation.uv[k];
      worst =
          std::max(worst, std::hypot(uv.u - truth.u, uv.v - truth.v) / found.observation.sigma[k]);
    }
    return worst;
  }

  LightVideo video_{kSize, kOptions, kWand};
  Motion motion_{MotionKind::kRandom, video_.camera(), kWand, 5};
};

// Turned about anyhow and up to 45 degrees towards the camera.
TEST_F(FollowedWand, IsNamedHoweverItIsTurned) {
  const int frames = scenes::full_count() ? 1000 : 100;
  int whole = 0;
  int found = 0;
  video_.look_at_the_room(3);
  for (int i = 0; i < frames; ++i) {
    const Places lights = at(i);
    const Places seen = seen_of(lights);
    const Detection now = video_.look(seen);
    if (seen.size() < 3) {
      EXPECT_FALSE(now.observation.found()) << i << ": two lights have no names";
      continue;
    }
    ++whole;
    if (!now.observation.found()) continue;
    ++found;
    EXPECT_EQ(now.observation.board, "wand:150mm+350mm");
    EXPECT_LT(error(now, lights), 6) << i;
  }
  std::cout << "  " << found << " of " << whole << " wands\n";
  EXPECT_GT(whole, frames / 3);
  EXPECT_GE(found, whole * 95 / 100);
}

// A weak image of the wand in a window is not taken, not even while the wand itself is covered; one
// as bright as the wand leaves open which is which.
TEST_F(FollowedWand, IsNotItsReflection) {
  const auto shifted = [](Places lights, double by) {
    for (Eigen::Vector3d& light : lights) light.y() += by;
    return lights;
  };
  const Places lights = {{-0.2, -0.15, 1.5}, {-0.06, -0.12, 1.53}, {0.27, -0.05, 1.6}};
  const Places image = shifted(lights, 0.3);
  Places both = lights;
  both.insert(both.end(), image.begin(), image.end());
  video_.look_at_the_room(3);
  EXPECT_LT(error(video_.look(both, {1, 1, 1, 0.05, 0.05, 0.05}), lights), 6);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(video_.look(image, {0.05, 0.05, 0.05}).observation.found()) << i;
  }
  const Detection equal = video_.look(both);
  EXPECT_FALSE(equal.observation.found());
  EXPECT_NE(equal.obstacle.find("reflects"), std::string::npos) << equal.obstacle;
  EXPECT_LT(error(video_.look(lights), lights), 6);
}

// Beside a lamp that is switched on the wand is still itself; lights that lie otherwise are none.
TEST_F(FollowedWand, IsThreeThatLieAsItsLights) {
  Places lights = {{-0.2, -0.15, 1.5}, {-0.06, -0.12, 1.53}, {0.27, -0.05, 1.6}};
  video_.look_at_the_room(3);
  Places with_lamp = lights;
  with_lamp.emplace_back(0.4, 0.3, 1.5);
  EXPECT_LT(error(video_.look(with_lamp), lights), 6);
  const Places bent = {lights[0], lights[1] + Eigen::Vector3d(0, 0.1, 0), lights[2]};
  const Detection otherwise = video_.look(bent);
  EXPECT_FALSE(otherwise.observation.found());
  EXPECT_NE(otherwise.obstacle.find("lies otherwise"), std::string::npos) << otherwise.obstacle;
  const Places halved = {lights[0], (lights[0] + lights[2]) / 2, lights[2]};
  EXPECT_FALSE(video_.look(halved).observation.found()) << "either end may be the first";
  EXPECT_FALSE(video_.look(Places{lights[0], lights[1]}).observation.found());
}

// One picture alone tells them too, where nothing else is bright.
TEST_F(FollowedWand, IsFoundInAPicture) {
  const Places lights = {{0.2, -0.15, 1.5}, {0.06, -0.12, 1.53}, {-0.27, -0.05, 1.6}};
  const GrayImage picture = video_.picture(lights);
  EXPECT_LT(error(video_.detector().detect(picture.view()), lights), 6);
  Places more = lights;
  more.emplace_back(0.4, 0.3, 1.5);
  const GrayImage unsure = video_.picture(more);
  EXPECT_FALSE(video_.detector().detect(unsure.view()).observation.found());
}

TEST(WandDetector, RefusesLightsThatNoPictureTellsApart) {
  for (const char* text : {"wand:500mm", "wand:250mm+250mm", "wand:100mm+150mm+300mm"}) {
    const auto detector = make_detector(parse_board(text).value());
    ASSERT_FALSE(detector.has_value()) << text;
    EXPECT_NE(detector.error().message.find("wand:150mm+350mm"), std::string::npos)
        << detector.error().message;
  }
}

}  // namespace
}  // namespace calvin
