// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detector on rendered boards, whose corners are known, and on the pictures of $CALVIN_DATA.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin_config.h"

#if CALVIN_HAVE_OPENCV
#include <opencv2/imgcodecs.hpp>
#endif

namespace calvin {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Board board(const std::string& text = "checkerboard:9x6:25mm") { return parse_board(text).value(); }
std::unique_ptr<Detector> detector(const Board& b) {
  auto made = make_detector(b);
  EXPECT_TRUE(made.has_value()) << made.error().message;
  return std::move(*made);
}
bool full() { return std::getenv("CALVIN_FULL") != nullptr; }

// The board's middle straight ahead, turned by `roll` about the line of sight.
SE3 ahead(const Board& b, double roll, double distance) {
  const Eigen::Matrix3d rotation = exp_so3({0.2, -0.25, 0}) * exp_so3({0, 0, roll});
  const Eigen::Vector3d middle(b.extent().width() / 2, b.extent().height() / 2, 0);
  return {rotation, Eigen::Vector3d(0.01, 0, distance) - rotation * middle};
}

double error_at(const Observation& found, const Observation& truth, std::size_t i) {
  return std::hypot(found.uv[i].u - truth.uv[i].u, found.uv[i].v - truth.uv[i].v);
}

struct Score {
  int found = 0;
  double rms = 0;
  double worst = 0;
  double outward = 0;  // mean error away from the principal point
  double chi = 0;      // of the errors, each by its sigma
};

Score score(const Camera& camera, const RenderOptions& options, int views) {
  const Board b = board();
  const BoardRenderer renderer(camera);
  const Motion motion(MotionKind::kRandom, camera, b, 21);
  const auto finder = detector(b);
  Score s;
  int points = 0;
  for (int i = 0; i < views; ++i) {
    RenderOptions o = options;
    o.seed = static_cast<std::uint64_t>(i);
    const SE3 pose = motion.camera_from_board(i);
    const auto found = finder->detect(renderer.render(b, pose, o).view()).observation;
    if (!found.found()) continue;
    ++s.found;
    const Observation truth = true_observation(camera, b, pose);
    EXPECT_EQ(found.ids, truth.ids);
    for (std::size_t k = 0; k < truth.uv.size(); ++k) {
      const double e = error_at(found, truth, k);
      const double du = truth.uv[k].u - camera.cx();
      const double dv = truth.uv[k].v - camera.cy();
      s.outward += ((found.uv[k].u - truth.uv[k].u) * du + (found.uv[k].v - truth.uv[k].v) * dv) /
                   std::hypot(du, dv);
      s.rms += e * e;
      s.chi += e * e / (2 * found.sigma[k] * found.sigma[k]);
      s.worst = std::max(s.worst, e);
      ++points;
    }
  }
  s.rms = std::sqrt(s.rms / points);
  s.chi = std::sqrt(s.chi / points);
  s.outward /= points;
  return s;
}

TEST(Checkerboard, IsFoundToAFewHundredthsOfAPixel) {
  const int views = full() ? 200 : 12;
  for (const double blur : {0.7, 1.2}) {
    const Score s = score(default_camera({640, 480}), {.noise = 2, .blur = blur}, views);
    std::cout << "  blur " << blur << ": " << s.found << " of " << views << " views, RMS " << s.rms
              << " px, worst " << s.worst << ", outward " << s.outward << '\n';
    EXPECT_GE(s.found, views * 95 / 100);
    EXPECT_LT(s.rms, 0.009);
    EXPECT_LT(s.worst, 0.1);
    // A bias that follows the distortion would go straight into the calibration.
    EXPECT_LT(std::abs(s.outward), 0.003);
  }
}

TEST(Checkerboard, IsFoundThroughAFisheyeLens) {
  const Camera camera =
      Camera::make("fisheye", {640, 480}, {230, 231, 322, 238, 0.01, -0.004, 0.001, -2e-4}).value();
  const int views = full() ? 200 : 12;
  const Score s = score(camera, {.noise = 2, .blur = 0.7}, views);
  std::cout << "  " << s.found << " of " << views << " views, RMS " << s.rms << " px, worst "
            << s.worst << '\n';
  EXPECT_GE(s.found, views * 9 / 10);
  EXPECT_LT(s.rms, 0.01);
  EXPECT_LT(s.worst, 0.15);
}

// Of each corner, not only on the average over large and small ones.
TEST(Checkerboard, TellsHowFarEachCornerIsOff) {
  for (const double noise : {3, 10}) {
    for (const int width : {640, 1280}) {
      const Score s = score(default_camera({width, width * 3 / 4}), {.noise = noise, .blur = 0.8},
                            full() ? 200 : 40);
      EXPECT_GT(s.chi, 0.9) << noise << " " << width;
      EXPECT_LT(s.chi, 1.1) << noise << " " << width;
    }
  }
}

TEST(Checkerboard, IsFoundInLargeImages) {
  const Camera camera = default_camera({1920, 1080});
  const Board b = board();
  const SE3 pose = ahead(b, 0.3, 0.6);
  const auto found =
      detector(b)->detect(render_board(camera, b, pose, {.noise = 2, .blur = 1}).view());
  ASSERT_EQ(found.reason, Reason::kAccepted);
  EXPECT_EQ(found.observation.image_size, (ImageSize{1920, 1080}));
  EXPECT_EQ(found.observation.sigma.size(), 54U);
  const Observation truth = true_observation(camera, b, pose);
  for (std::size_t i = 0; i < truth.uv.size(); ++i) {
    EXPECT_LT(error_at(found.observation, truth, i), 0.1);
  }
}

struct Roll {
  const char* board;
  std::vector<Relabelling> ambiguous;
};
class RolledBoard : public ::testing::TestWithParam<Roll> {};
INSTANTIATE_TEST_SUITE_P(Boards, RolledBoard,
                         ::testing::Values(Roll{"checkerboard:9x6:25mm", {}},
                                           Roll{"checkerboard:6x9:25mm", {}},
                                           Roll{"checkerboard:8x6:25mm", {{2}}},
                                           Roll{"checkerboard:7x7:25mm", {{2}}},
                                           Roll{"checkerboard:9x5:25mm", {{2}}},
                                           Roll{"checkerboard:6x6:25mm", {{1}, {2}, {3}}}));

TEST_P(RolledBoard, HasItsControlPointsWhereTheyAre) {
  const Camera camera = default_camera({640, 480});
  const Board b = board(GetParam().board);
  const BoardRenderer renderer(camera);
  const auto finder = detector(b);
  for (int roll = 20; roll < 360; roll += 90) {
    const SE3 pose = ahead(b, roll * kDegree, 0.6);
    const auto found = finder->detect(renderer.render(b, pose, {.noise = 2, .blur = 0.7}).view());
    ASSERT_EQ(found.reason, Reason::kAccepted) << roll;
    EXPECT_EQ(found.observation.ambiguous, GetParam().ambiguous);
    EXPECT_EQ(found.observation.board, b.text());
    // One of the labellings that the board leaves is the truth, the same for all points.
    const Observation truth = true_observation(camera, b, pose);
    const auto turned = [&](std::size_t i, int quarter) {
      const Grid grid = b.grid().value();
      int c = static_cast<int>(i) % grid.cols;
      int r = static_cast<int>(i) / grid.cols;
      int cols = grid.cols;
      int rows = grid.rows;
      for (int k = 0; k < quarter; ++k) {
        const int keep = c;
        c = rows - 1 - r;
        r = keep;
        std::swap(cols, rows);
      }
      return static_cast<std::size_t>(r * grid.cols + c);
    };
    std::vector<int> quarters = {0};
    for (const Relabelling& turn : GetParam().ambiguous) quarters.push_back(turn.quarter_turns);
    int right = 0;
    for (const int quarter : quarters) {
      double worst = 0;
      for (std::size_t i = 0; i < truth.uv.size(); ++i) {
        const Pixel at = truth.uv[turned(i, quarter)];
        worst = std::max(
            worst, std::hypot(at.u - found.observation.uv[i].u, at.v - found.observation.uv[i].v));
      }
      right += worst < 0.2;
    }
    EXPECT_EQ(right, 1) << "roll " << roll;
    // Of equal labellings the one with point 0 nearest to the top left.
    for (const int quarter : quarters) {
      const Pixel at = truth.uv[turned(0, quarter)];
      EXPECT_LE(std::hypot(found.observation.uv[0].u, found.observation.uv[0].v),
                std::hypot(at.u, at.v) + 0.2);
    }
  }
}

TEST(NoBoard, IsNotFoundInOtherThings) {
  const auto finder = detector(board());
  const auto nothing = [&](const GrayImage& image) {
    const Detection d = finder->detect(image.view());
    return !d.observation.found() && d.observation.uv.empty() && d.observation.sigma.empty() &&
           d.observation.ambiguous.empty() && d.reason != Reason::kAccepted;
  };
  std::mt19937 random(3);
  GrayImage noise(640, 480);
  for (auto& pixel : noise.pixels) pixel = static_cast<std::uint8_t>(random() & 255);
  EXPECT_TRUE(nothing(noise));
  EXPECT_TRUE(nothing(GrayImage(640, 480, 200)));

  const Camera camera = default_camera({640, 480});
  const BoardRenderer renderer(camera);
  for (const char* other :
       {"checkerboard:11x8:25mm", "checkerboard:10x6:25mm", "checkerboard:9x7:25mm",
        "checkerboard:8x6:25mm", "checkerboard:9x5:25mm", "checkerboard:8x5:25mm"}) {
    const Board b = board(other);
    for (const double roll : {0.1, 1.9}) {
      EXPECT_TRUE(nothing(renderer.render(b, ahead(b, roll, 0.6), {.noise = 2, .blur = 0.7})))
          << other << " at " << roll;
    }
  }
}

TEST(NoBoard, ReportsTheSizeOfAnother) {
  const auto finder = detector(board());
  const Camera camera = default_camera({640, 480});
  const Board b = board("checkerboard:10x6:25mm");
  const Detection d =
      finder->detect(render_board(camera, b, ahead(b, 0.1, 0.6), {.noise = 2, .blur = 0.7}).view());
  EXPECT_EQ(d.reason, Reason::kWrongBoard);
  EXPECT_EQ(d.seen_cols, 10);
  EXPECT_EQ(d.seen_rows, 6);
}

// The board moves out of the image, and its corners with it.
void expect_parts(const Board& b) {
  const auto finder = detector(b);
  const Camera camera = default_camera({640, 480});
  const BoardRenderer renderer(camera);
  const auto count = static_cast<std::size_t>(b.point_count());
  int parts = 0;
  for (double shift = 0.2; shift < 0.34; shift += full() ? 0.0005 : 0.002) {
    SE3 pose = ahead(b, 0, 0.4);
    pose.translation.x() += shift;
    const Observation truth = true_observation(camera, b, pose);
    ASSERT_LT(truth.ids.size(), count) << shift;
    const auto found = finder->detect(renderer.render(b, pose, {.noise = 2, .blur = 0.7}).view());
    if (3 * truth.ids.size() < 2 * count) continue;  // the ends of too few squares are in view
    ++parts;
    ASSERT_EQ(found.reason, Reason::kAccepted) << shift;
    EXPECT_TRUE(found.observation.ambiguous.empty()) << shift;
    EXPECT_GE(10 * found.observation.ids.size(), 8 * truth.ids.size()) << shift;
    for (std::size_t i = 0; i < found.observation.ids.size(); ++i) {
      const auto at = std::find(truth.ids.begin(), truth.ids.end(), found.observation.ids[i]);
      ASSERT_NE(at, truth.ids.end());
      const Pixel uv = truth.uv[static_cast<std::size_t>(at - truth.ids.begin())];
      EXPECT_LT(std::hypot(uv.u - found.observation.uv[i].u, uv.v - found.observation.uv[i].v),
                0.15);
    }
  }
  EXPECT_GE(parts, 10);
}

TEST(Parts, AreFoundWithTheirIds) { expect_parts(board()); }

TEST(Parts, OfALargerBoardToo) { expect_parts(board("checkerboard:11x8:25mm")); }

TEST(Images, MayHaveAnyStrideAndStep) {
  const Camera camera = default_camera({640, 480});
  const SE3 pose = ahead(board(), 0.4, 0.5);
  const GrayImage image = render_board(camera, board(), pose, {.noise = 1, .blur = 0.7});
  const auto finder = detector(board());
  const auto expected = finder->detect(image.view()).observation;
  ASSERT_TRUE(expected.found());
  std::vector<std::uint8_t> packed(480 * 1300, 99);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x)
      packed[static_cast<std::size_t>(1300 * y + 2 * x)] = image.view().at(x, y);
  }
  const std::vector<std::uint8_t> before = packed;
  std::vector<std::uint8_t> flipped(image.pixels.size());
  for (int y = 0; y < 480; ++y) {
    std::copy_n(image.pixels.begin() + 640 * y, 640, flipped.begin() + 640 * (479 - y));
  }
  for (const ImageView& view : {ImageView{packed.data(), 640, 480, 1300, 2},
                                ImageView{flipped.data() + 640 * 479, 640, 480, -640, 1}}) {
    const auto found = finder->detect(view).observation;
    ASSERT_EQ(found.uv.size(), expected.uv.size());
    for (std::size_t i = 0; i < found.uv.size(); ++i) {
      EXPECT_EQ(found.uv[i].u, expected.uv[i].u);
      EXPECT_EQ(found.uv[i].v, expected.uv[i].v);
    }
  }
  EXPECT_EQ(packed, before);
}

TEST(Images, MayBeOfAnySize) {
  const auto finder = detector(board());
  EXPECT_FALSE(finder->detect({}).observation.found());
  for (const int width : {1, 2, 3, 7, 15, 16, 17, 33, 64, 4000}) {
    for (const int height : {1, 2, 5, 16, 31}) {
      GrayImage image(width, height);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = static_cast<std::uint8_t>(37 * i);
      }
      EXPECT_FALSE(finder->detect(image.view()).observation.found()) << width << "x" << height;
    }
  }
}

TEST(Detectors, RefuseWhatTheyCannotFind) {
  const auto made = make_detector(board("checkerboard:2x6:25mm"));
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(made.error().message.find("2x6"), std::string::npos);
}

TEST(Detectors, StopWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const Camera camera = default_camera({640, 480});
  const GrayImage image = render_board(camera, board(), ahead(board(), 0, 0.5));
  const auto finder = detector(board());
  EXPECT_FALSE(finder->detect(image.view(), stop.get_token()).observation.found());
  EXPECT_TRUE(finder->detect(image.view()).observation.found());
}

#if CALVIN_HAVE_OPENCV
TEST(RealPictures, OfOpenCVsSamplesAreFound) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder = std::filesystem::path(data == nullptr ? "" : data) / "opencv-samples";
  if (data == nullptr || !std::filesystem::exists(folder)) {
    GTEST_SKIP() << "CALVIN_DATA names no folder with opencv-samples/left*.jpg";
  }
  const auto finder = detector(board("checkerboard:9x6:25mm"));
  int pictures = 0;
  int found = 0;
  for (int i = 1; i <= 14; ++i) {
    const auto file = folder / (i < 10 ? "left0" + std::to_string(i) + ".jpg"
                                       : "left" + std::to_string(i) + ".jpg");
    if (!std::filesystem::exists(file)) continue;  // there is no left10.jpg
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    ++pictures;
    const ImageView view = {image.data, image.cols, image.rows,
                            static_cast<std::ptrdiff_t>(image.step[0]), 1};
    found += finder->detect(view).observation.found();
  }
  std::cout << "  " << found << " of " << pictures << " pictures\n";
  ASSERT_EQ(pictures, 13);
  EXPECT_EQ(found, 13);
}
#endif

}  // namespace
}  // namespace calvin
