// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A light in a video: covered, paused, reflected, before lamps that are switched on and light that
// changes; frames of any content.
#include <cmath>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "light_video.hpp"

namespace calvin {
namespace {

using scenes::LightVideo;
using Places = std::vector<Eigen::Vector3d>;

constexpr ImageSize kSize = {640, 480};
const RenderOptions kOptions = {.noise = 2, .blur = 0.8, .dark = 25, .glow = 1500};

class FollowedLight : public ::testing::Test {
 protected:
  // Where the light is in the frame of that number, m.
  [[nodiscard]] Eigen::Vector3d at(double frame) const {
    return motion_.camera_from_board(frame / 30).translation;
  }
  // px, of what was found from the light there; more than any picture has where nothing was.
  [[nodiscard]] double error(const Detection& seen, const Eigen::Vector3d& light) const {
    if (!seen.observation.found()) return 1e6;
    const Pixel truth = video_.camera().project(light).value();
    return std::hypot(seen.observation.uv[0].u - truth.u, seen.observation.uv[0].v - truth.v);
  }

  LightVideo video_{kSize, kOptions};
  Motion motion_{MotionKind::kHand, video_.camera(), LightVideo::light(), 2};
};

// What the first frame shows is the background, and is forgotten where the light moves on.
TEST_F(FollowedLight, IsFoundFromItsFirstMovesOn) {
  EXPECT_FALSE(video_.look(at(0)).observation.found());
  int found = 0;
  for (int i = 1; i <= 60; ++i) {
    const double off = error(video_.look(at(i)), at(i));
    found += off < 1 ? 1 : 0;
    if (i > 15) {
      EXPECT_LT(off, 0.2) << i;
    }
  }
  EXPECT_GE(found, 50);
}

// As soon as it has moved on, it may come back.
TEST_F(FollowedLight, IsFoundWhereItWasInTheFirstFrame) {
  const auto place = [&](Pixel p) -> Eigen::Vector3d {
    return 1.5 * video_.camera().unproject(p).value();
  };
  (void)video_.look(place({300, 200}));
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d elsewhere = place({100.0 + 3 * i, 100});
    EXPECT_LT(error(video_.look(elsewhere), elsewhere), 0.2) << i;
  }
  const Eigen::Vector3d back = place({303, 201});
  EXPECT_LT(error(video_.look(back), back), 0.2);
}

TEST_F(FollowedLight, IsNotFoundWhileItIsCovered) {
  video_.look_at_the_room(2);
  for (int i = 0; i < 90; ++i) {
    const bool covered = i % 30 >= 10 && i % 30 < 20;
    const Detection seen = video_.look(covered ? Places{} : Places{at(i)});
    EXPECT_EQ(seen.observation.found(), !covered) << i;
    if (covered) {
      EXPECT_EQ(seen.reason, Reason::kNotFound);
    } else {
      EXPECT_LT(error(seen, at(i)), 0.2) << i;
    }
  }
}

TEST_F(FollowedLight, IsNotLearntWhenItPauses) {
  video_.look_at_the_room(2);
  for (int i = 0; i < 20; ++i) (void)video_.look(at(i));
  for (int i = 0; i < 600; ++i) EXPECT_LT(error(video_.look(at(20)), at(20)), 0.25) << i;
  for (int i = 20; i < 60; ++i) EXPECT_LT(error(video_.look(at(i)), at(i)), 0.25) << i;
}

// A lamp that is switched on is a light like the one that moves; after half a second it stands.
TEST_F(FollowedLight, GoesOnBesideALampThatIsSwitchedOn) {
  video_.look_at_the_room(2);
  for (int i = 0; i < 20; ++i) (void)video_.look(at(i));
  const Eigen::Vector3d lamp = 1.5 * video_.camera().unproject({100, 400}).value();
  for (int i = 20; i < 80; ++i) {
    EXPECT_LT(error(video_.look(Places{at(i), lamp}), at(i)), 0.2) << i;
  }
  // It stays a lamp where the light is covered.
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(video_.look(Places{lamp}).observation.found()) << i;
  for (int i = 80; i < 120; ++i) {
    EXPECT_LT(error(video_.look(Places{at(i), lamp}), at(i)), 0.2) << i;
  }
}

TEST_F(FollowedLight, IsTheBrighterOneOfItAndItsReflection) {
  video_.look_at_the_room(2);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d light = at(i);
    const Eigen::Vector3d mirrored = {-light.x(), 0.1 - light.y(), light.z()};
    const Pixel a = video_.camera().project(light).value();
    const Pixel b = video_.camera().project(mirrored).value();
    if (std::hypot(a.u - b.u, a.v - b.v) < 40) continue;
    EXPECT_LT(error(video_.look({light, mirrored}, {1, 0.1}), light), 0.2) << i;
  }
}

// Of two that are as bright the one that goes on is taken; when both appear, none.
TEST_F(FollowedLight, IsNotOneOfTwoThatCannotBeToldApart) {
  video_.look_at_the_room(2);
  // Elsewhere, and as far away.
  const auto other = [&](int i) -> Eigen::Vector3d {
    return at(i).norm() * at(i + 400).normalized();
  };
  int told = 0;
  for (int i = 0; i < 10; ++i) {
    const Detection seen = video_.look({at(i), other(i)}, {1, 0.9});
    EXPECT_FALSE(seen.observation.found()) << i;
    told += seen.obstacle.find("Several lights") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(told, 10);
  for (int i = 10; i < 20; ++i) EXPECT_LT(error(video_.look(at(i)), at(i)), 0.2) << i;
  for (int i = 20; i < 34; ++i) {
    EXPECT_LT(error(video_.look({at(i), other(i)}, {1, 0.9}), at(i)), 0.2) << i;
  }
}

// While the light is covered, its weak reflection elsewhere is not taken for it.
TEST_F(FollowedLight, IsNotItsReflectionWhileItIsCovered) {
  video_.look_at_the_room(2);
  for (int i = 0; i < 30; ++i) (void)video_.look(at(i));
  int told = 0;
  for (int i = 30; i < 50; ++i) {
    const Eigen::Vector3d mirrored = at(29).norm() * at(i + 900).normalized();
    const Detection seen = video_.look(Places{mirrored}, {0.055});
    EXPECT_FALSE(seen.observation.found()) << i;
    told += seen.obstacle.find("reflection") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(told, 15) << "some are too dim to be seen";
}

TEST_F(FollowedLight, IsFoundWhileTheRoomGetsBrighter) {
  video_.look_at_the_room(2);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    video_.options().dark = 25 + 60 * std::sin(i / 60.0) * std::sin(i / 60.0);
    found += error(video_.look(at(i)), at(i)) < 0.3 ? 1 : 0;
  }
  EXPECT_GE(found, 295);
  // All at once it is another scene, which is learnt anew.
  video_.options().dark = 160;
  for (int i = 300; i < 340; ++i) {
    const Detection seen = video_.look(at(i));
    if (i > 315) {
      EXPECT_LT(error(seen, at(i)), 0.3) << i;
    }
  }
}

// A room in which all kinds of things are moved, but no light.
TEST_F(FollowedLight, IsNoBoardThatIsMoved) {
  int found = 0;
  int frames = 0;
  for (const char* text : {"checkerboard:9x6:25mm", "circles:7x5:30mm:inverted", "puzzle:14x9:18mm",
                           "acircles:4x11:20mm"}) {
    const Board board = parse_board(text).value();
    const Motion hand(MotionKind::kHand, video_.camera(), board, 3);
    const BoardRenderer renderer(video_.camera());
    const auto detector = make_detector(LightVideo::light()).value();
    for (int i = 0; i < (scenes::full_count() ? 300 : 60); ++i) {
      const auto seed = static_cast<std::uint64_t>(i);
      const GrayImage image = renderer.render(board, hand.camera_from_board(i / 30.0),
                                              {.noise = 2, .blur = 0.8, .seed = seed});
      found += detector->follow(image.view(), 33'333'333 * seed).observation.found() ? 1 : 0;
      ++frames;
    }
  }
  std::cout << "  " << found << " of " << frames << " frames\n";
  EXPECT_EQ(found, 0);
}

// Another size or an earlier time is another video.
TEST_F(FollowedLight, IsAnotherOneInAnotherVideo) {
  video_.look_at_the_room(2);
  EXPECT_TRUE(video_.look(at(0)).observation.found());
  LightVideo smaller({320, 240}, kOptions);
  EXPECT_FALSE(
      video_.detector().follow(smaller.picture({at(1)}).view(), 500'000'000).observation.found());
  EXPECT_TRUE(
      video_.detector().follow(smaller.picture({at(30)}).view(), 533'333'333).observation.found());
  EXPECT_FALSE(
      video_.detector().follow(smaller.picture({at(60)}).view(), 400'000'000).observation.found())
      << "nothing is known of the room in an earlier frame";
}

// Luma between other bytes, as YUY2 has it.
TEST_F(FollowedLight, IsFoundWherePixelsLieApart) {
  const auto detector = make_detector(LightVideo::light()).value();
  for (int i = 0; i < 20; ++i) {
    const GrayImage image = video_.picture(i == 0 ? Places{} : Places{at(i)});
    std::vector<std::uint8_t> apart(2 * image.pixels.size() + 77, 200);
    for (std::size_t k = 0; k < image.pixels.size(); ++k) apart[2 * k] = image.pixels[k];
    const ImageView view = {apart.data(), image.width, image.height, 2 * image.width, 2};
    const Detection seen = detector->follow(view, static_cast<std::uint64_t>(i));
    if (i > 0) {
      EXPECT_LT(error(seen, at(i)), 0.2) << i;
    }
  }
}

TEST_F(FollowedLight, OfAnyImagesOfAnySizeIsNoTrouble) {
  const auto detector = make_detector(LightVideo::light()).value();
  scenes::Random random(1);
  std::uint64_t time = 0;
  for (const ImageSize size : {ImageSize{0, 0}, {1, 1}, {3, 200}, {200, 2}, {17, 9}, {160, 121}}) {
    for (int i = 0; i < 30; ++i) {
      const ImageSize now = i % 7 == 6 ? ImageSize{size.height, size.width} : size;
      GrayImage image(now.width, now.height);
      const int kind = static_cast<int>(random() % 4);
      for (auto& pixel : image.pixels) {
        pixel = static_cast<std::uint8_t>(kind == 0   ? random()
                                          : kind == 1 ? 255 * (random() % 2)
                                          : kind == 2 ? (random() % 64 == 0 ? 255 : 0)
                                                      : 77);
      }
      const Detection seen =
          i % 3 == 0 ? detector->detect(image.view()) : detector->follow(image.view(), time += 100);
      for (std::size_t k = 0; k < seen.observation.uv.size(); ++k) {
        EXPECT_TRUE(std::isfinite(seen.observation.uv[k].u + seen.observation.uv[k].v));
        EXPECT_GT(seen.observation.sigma[k], 0);
        EXPECT_LT(seen.observation.uv[k].u, now.width);
        EXPECT_LT(seen.observation.uv[k].v, now.height);
      }
    }
  }
  std::stop_source stop;
  stop.request_stop();
  const GrayImage image = video_.picture({at(0)});
  EXPECT_FALSE(detector->detect(image.view(), stop.get_token()).observation.found());
}

TEST(SeveralLights, AreRefusedWithAWord) {
  const std::vector<Board> two(2, LightVideo::light());
  const auto refused = make_detector(two);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(refused.error().message.find("name dot once"), std::string::npos);
}

// Beside a board, each by its own detector.
TEST(ALightAndABoard, AreFoundInOnePicture) {
  const std::vector<Board> both = {LightVideo::light(), scenes::kBoard};
  const auto detector = make_detector(both).value();
  LightVideo video(kSize, kOptions);
  const SE3 pose = {exp_so3({0.2, 0.1, 0}), {-0.25, -0.06, 0.6}};
  const GrayImage board =
      render_board(video.camera(), scenes::kBoard, pose, {.noise = 2, .blur = 0.8});
  const Eigen::Vector3d at = 1.5 * video.camera().unproject({560, 100}).value();
  for (int i = 0; i < 3; ++i) {
    GrayImage image = video.picture(i < 2 ? Places{} : Places{at});
    for (int y = 0; y < image.height; ++y) {
      std::copy_n(board.pixels.begin() + static_cast<std::ptrdiff_t>(y) * image.width, 440,
                  image.row(y));
    }
    const auto found = detector->follow_all(image.view(), static_cast<std::uint64_t>(i));
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].observation.board, "dot");
    EXPECT_EQ(found[0].observation.found(), i == 2);
    EXPECT_EQ(found[1].observation.ids.size(), 54U);
  }
}

}  // namespace
}  // namespace calvin
