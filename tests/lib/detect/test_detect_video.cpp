// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards in rendered video: followed from frame to frame, and judged by how still and how sharp
// they are.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/session/session.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;

constexpr std::uint64_t kFrame = 33'333'333;  // ns

double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Videos : public ::testing::Test {
 protected:
  GrayImage frame(int number, double seconds) const {
    return renderer_.render(
        kBoard, motion_.camera_from_board(seconds),
        {.noise = 2, .blur = 0.8, .seed = noise_seed(3, static_cast<std::uint64_t>(number))});
  }

  Camera camera_ = default_camera({1280, 720});
  BoardRenderer renderer_{camera_};
  Motion motion_{MotionKind::kHand, camera_, kBoard, 5};
};

TEST_F(Videos, AreFollowedAsIfEachFrameWereSearched) {
  const auto follower = std::move(*make_detector(kBoard));
  const auto searcher = std::move(*make_detector(kBoard));
  const int frames = scenes::full_count() ? 600 : 60;
  std::vector<double> followed;
  std::vector<double> searched;
  for (int n = 0; n < frames; ++n) {
    const GrayImage image = frame(n, n / 30.0);
    const double begin = thread_ms();
    const auto a = follower->follow(image.view(), static_cast<std::uint64_t>(n) * kFrame);
    const double middle = thread_ms();
    const auto b = searcher->detect(image.view());
    followed.push_back(middle - begin);
    searched.push_back(thread_ms() - middle);
    ASSERT_EQ(a.reason, b.reason) << n;
    ASSERT_EQ(a.observation.ids, b.observation.ids) << n;
    EXPECT_EQ(a.observation.ambiguous, b.observation.ambiguous);
    for (std::size_t i = 0; i < a.observation.uv.size(); ++i) {
      const Pixel p = a.observation.uv[i];
      const Pixel q = b.observation.uv[i];
      // Fits of the same pixels from other starts, with the bends of edges that the frame before
      // has told; in rare ones another window.
      EXPECT_LT(std::hypot(p.u - q.u, p.v - q.v), std::max(b.observation.sigma[i] / 2, 0.03)) << n;
    }
  }
  std::cout << "  " << median(followed) << " ms a frame followed, " << median(searched)
            << " ms searched\n";
}

// Edges are bent otherwise in every frame there: what the one before has told of them is made good.
TEST(VideosBeforeAFisheye, AreFollowedAsIfEachFrameWereSearched) {
  const Camera camera =
      Camera::make("fisheye", {640, 480}, {190, 190, 319.5, 239.5, 0, 0, 0, 0}).value();
  const BoardRenderer renderer(camera);
  const auto follower = std::move(*make_detector(kBoard));
  const auto searcher = std::move(*make_detector(kBoard));
  double followed = 0;
  double searched = 0;
  for (int n = 0; n < 16; ++n) {
    const SE3 pose = {exp_so3({0.05, 0.2, 0.1}), {-0.18 + 0.01 * n, -0.07 + 0.003 * n, 0.16}};
    const GrayImage image = renderer.render(kBoard, pose, {.blur = 0.8});
    const Observation truth = true_observation(camera, kBoard, pose);
    const auto a = follower->follow(image.view(), static_cast<std::uint64_t>(n) * kFrame);
    const auto b = searcher->detect(image.view());
    ASSERT_EQ(a.observation.ids, truth.ids) << n;
    ASSERT_EQ(b.observation.ids, truth.ids) << n;
    const auto square = [&](const Observation& seen) {
      double sum = 0;
      for (std::size_t i = 0; i < truth.uv.size(); ++i) {
        sum +=
            std::pow(seen.uv[i].u - truth.uv[i].u, 2) + std::pow(seen.uv[i].v - truth.uv[i].v, 2);
      }
      return sum;
    };
    followed += square(a.observation);
    searched += square(b.observation);
  }
  std::cout << "  " << std::sqrt(followed / searched) << " of the error, which is "
            << std::sqrt(searched / 2 / 16 / 54) << " px\n";
  EXPECT_LT(std::sqrt(followed / searched), 1.2);
}

TEST_F(Videos, GiveALostBoardBackInTheNextFrame) {
  const auto follower = std::move(*make_detector(kBoard));
  std::uint64_t now = 0;
  int back = 0;
  for (int n = 0; n < 40; ++n) {
    // Away for two frames in seven, and elsewhere when it comes back.
    const bool away = n % 7 >= 5;
    const int visit = n / 7;
    const GrayImage image = away ? GrayImage(1280, 720, 128) : frame(n, visit * 3.7 + n / 30.0);
    const auto seen = follower->follow(image.view(), now += kFrame).observation;
    EXPECT_EQ(seen.found(), !away) << n;
    if (away || !seen.found()) continue;
    const Observation truth =
        true_observation(camera_, kBoard, motion_.camera_from_board(visit * 3.7 + n / 30.0));
    ASSERT_EQ(seen.ids, truth.ids) << n;
    for (std::size_t i = 0; i < seen.uv.size(); ++i) {
      EXPECT_LT(std::hypot(seen.uv[i].u - truth.uv[i].u, seen.uv[i].v - truth.uv[i].v), 0.1);
    }
    back += n % 7 == 0 ? 1 : 0;
  }
  EXPECT_EQ(back, 6);
}

// A frame of another size, a cut, time that runs backwards: nothing is taken from the frame before.
TEST_F(Videos, MayJump) {
  const auto follower = std::move(*make_detector(kBoard));
  const Camera small = default_camera({640, 480});
  const Motion poses(MotionKind::kRandom, small, kBoard, 2);
  for (int n = 0; n < 12; ++n) {
    const SE3 pose = poses.camera_from_board(n);
    const GrayImage image =
        n % 4 == 3 ? frame(n, n) : render_board(small, kBoard, pose, {.noise = 2, .blur = 0.8});
    const auto now = static_cast<std::uint64_t>(n % 3 == 0 ? 20 - n : 20 + n) * kFrame;
    const auto seen = follower->follow(image.view(), n == 5 ? kNoTimestamp : now).observation;
    ASSERT_TRUE(seen.found()) << n;
    EXPECT_EQ(seen.image_size, image.size());
    if (n % 4 == 3) continue;
    const Observation truth = true_observation(small, kBoard, pose);
    for (std::size_t i = 0; i < seen.uv.size(); ++i) {
      EXPECT_LT(std::hypot(seen.uv[i].u - truth.uv[i].u, seen.uv[i].v - truth.uv[i].v), 0.15);
    }
  }
}

// How a session judges a board that moves by `step` m between two frames, its picture blurred by
// `blur` px.
struct Judged {
  double step;
  double blur;
  double readout;  // s
  Reason reason;
};
class Stillness : public ::testing::TestWithParam<Judged> {};
INSTANTIATE_TEST_SUITE_P(
    Boards, Stillness,
    ::testing::Values(Judged{0, 0.8, 0, Reason::kAccepted},
                      // 1000 px of focal length at 0.5 m: 0.05 and 0.4 px in a frame.
                      Judged{0.000025, 0.8, 0, Reason::kAccepted},
                      Judged{0.0002, 0.8, 0, Reason::kMoving},
                      // Read out in a tenth of the time it takes to the next frame.
                      Judged{0.0002, 0.8, 0.0033, Reason::kAccepted},
                      Judged{0.002, 0.8, 0.0033, Reason::kMoving},
                      Judged{0, 1.6, 0, Reason::kAccepted}, Judged{0, 4, 0, Reason::kBlurred}));

TEST_P(Stillness, IsJudgedByCornersAndEdges) {
  const Judged& p = GetParam();
  const Camera camera = Camera::make("pinhole", {1280, 720}, {1000, 1000, 639.5, 359.5}).value();
  const auto finder = std::move(*make_detector(kBoard));
  for (const double noise : {1.0, 8.0}) {
    Session session({CaptureMode::kAuto, 3, 0, p.readout});
    Reason reason = Reason::kNotFound;
    for (int n = 0; n < 2; ++n) {
      const SE3 pose = {exp_so3({0.1, 0.2, 0}), {-0.1 + n * p.step, -0.06, 0.5}};
      const GrayImage image =
          render_board(camera, kBoard, pose,
                       {.noise = noise, .blur = p.blur, .seed = static_cast<std::uint64_t>(n)});
      Observation seen = finder->detect(image.view()).observation;
      ASSERT_TRUE(seen.found());
      // The pixel's own square blurs too: 1/12 px^2.
      EXPECT_NEAR(seen.blur, std::sqrt(p.blur * p.blur + 1.0 / 12), 0.1 + 0.02 * p.blur);
      seen.timestamp = static_cast<std::uint64_t>(n) * kFrame;
      reason = session.offer({seen, kBoard});
    }
    EXPECT_EQ(reason, p.reason) << "noise " << noise << ": " << to_string(reason);
  }
}

}  // namespace
}  // namespace calvin
