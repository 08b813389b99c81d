// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards from close by and before strong lenses: squares that are large, of which windows take in
// much of an edge and depend on how it bends, which at the ends of short lines no neighbours tell;
// and boards that fill the picture of a fisheye, whose squares differ by far in size.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/detect/identify.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::uniform;

constexpr ImageSize kPicture = {1280, 720};

struct Large {
  const char* name;
  const char* board;
  const char* lens;
  double gamma;  // of the camera: with 1, grey levels are proportional to the light
};

void PrintTo(const Large& large, std::ostream* out) { *out << large.name; }

Camera camera_of(const std::string& lens) {
  const auto make = [](const char* model, const std::vector<double>& parameters) {
    return Camera::make(model, kPicture, parameters).value();
  };
  if (lens == "mild") return default_camera(kPicture);
  if (lens == "fisheye") {
    return make("fisheye", {420, 421, 633, 366, -0.012, 0.004, -0.002, 0.0002});
  }
  return make("brown5", {760, 762, 651.2, 352.4, -0.3, 0.115, -0.0004, 0.0005, -0.018});
}

// A board that is `least` to `most` of the picture wide, up to `tilt` degrees from the line of
// sight; all of it is seen.
struct Poses {
  double least = 0.35;
  double most = 0.6;
  double tilt = 40;
};

SE3 pose_of(const Camera& camera, const Board& board, const Poses& poses, Random& random) {
  const Eigen::Vector3d middle = board.points().back() / 2;
  for (;;) {
    const auto ray = camera.unproject({uniform(random, 300, 980), uniform(random, 200, 520)});
    if (!ray) continue;
    const double tilt = uniform(random, 0, poses.tilt) * std::numbers::pi / 180;
    const double side = uniform(random, 0, 2 * std::numbers::pi);
    const double extent = uniform(random, poses.least, poses.most) * kPicture.width;
    const Eigen::Matrix3d turn = rotation_between(Eigen::Vector3d::UnitZ(), *ray) *
                                 exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}) *
                                 exp_so3({0, 0, uniform(random, -3, 3)});
    const double far = camera.fx() * (2 * middle).norm() / extent;
    const SE3 pose = {turn, *ray * far - turn * middle};
    if (true_observation(camera, board, pose).ids.size() == board.points().size()) return pose;
  }
}

// What a camera of this gamma shows; bright squares look larger then.
GrayImage as_shown(GrayImage image, double gamma, Random& random) {
  std::normal_distribution<double> noise(0, 1);
  for (std::uint8_t& pixel : image.pixels) {
    const double grey = 255 * std::pow(pixel / 255.0, 1 / gamma) + noise(random);
    pixel = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
  }
  return image;
}

// A picture of a board, and where its points are.
struct Picture {
  GrayImage image;
  Observation truth;
};

// Pictures of a board through a lens, each from another place.
class Pictures {
 public:
  Pictures(Board board, const std::string& lens, std::uint64_t seed)
      : board_(std::move(board)), camera_(camera_of(lens)), renderer_(camera_), random_(seed) {}

  Picture next(const Poses& poses, double gamma = 1) {
    const SE3 pose = pose_of(camera_, board_, poses, random_);
    return {as_shown(renderer_.render(board_, pose, {.blur = 0.5}), gamma, random_),
            true_observation(camera_, board_, pose)};
  }

 private:
  Board board_;
  Camera camera_;
  BoardRenderer renderer_;
  Random random_;
};

class LargeSquares : public ::testing::TestWithParam<Large> {};
INSTANTIATE_TEST_SUITE_P(
    Pictures, LargeSquares,
    ::testing::Values(
        Large{"CharucoBeforeFisheye", "charuco:5x7:35mm:26mm:DICT_5X5_100", "fisheye", 1},
        Large{"CharucoOfAGamma", "charuco:5x7:35mm:26mm:DICT_5X5_100", "fisheye", 2.2},
        Large{"CharucoBeforeBarrel", "charuco:5x7:35mm:26mm:DICT_5X5_100", "barrel", 2.2},
        Large{"SquaresBeforeFisheye", "checkerboard:5x4:35mm", "fisheye", 1},
        Large{"SquaresOfAGamma", "checkerboard:5x4:35mm", "fisheye", 2.2},
        Large{"SquaresBeforeBarrel", "checkerboard:5x4:35mm", "barrel", 1}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_P(LargeSquares, AreAsFarOffAsTheySay) {
  const Large& large = GetParam();
  const Board board = parse_board(large.board).value();
  Pictures pictures(board, large.lens, 71);
  const auto detector = std::move(*make_detector(board));
  double chi = 0;
  double square = 0;
  int corners = 0;
  const int views = scenes::full_count() ? 60 : 12;
  int found = 0;
  for (int n = 0; n < views; ++n) {
    const Picture picture = pictures.next({}, large.gamma);
    const Observation seen = detector->detect(picture.image.view()).observation;
    if (!seen.found()) continue;
    ++found;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const Pixel at = picture.truth.uv[static_cast<std::size_t>(seen.ids[i])];
      const double off = std::pow(seen.uv[i].u - at.u, 2) + std::pow(seen.uv[i].v - at.v, 2);
      square += off / 2;
      chi += off / 2 / (seen.sigma[i] * seen.sigma[i]);
      ++corners;
    }
  }
  chi = std::sqrt(chi / corners);
  std::cout << "  " << found << " of " << views << ", RMS " << std::sqrt(square / corners)
            << " px, errors over sigmas " << chi << '\n';
  EXPECT_GE(found, views * 9 / 10);
  EXPECT_LT(std::sqrt(square / corners), large.gamma > 1 ? 0.012 : 0.004);
  EXPECT_LT(chi, large.gamma > 1 ? 2 : 1.25);
  EXPECT_GT(chi, 0.6);
}

// Boards from close by, whose squares differ by far in size: before a fisheye whose picture they
// fill, and small ones at a slant.
struct CloseBy {
  const char* name;
  const char* board;
  const char* lens;
  Poses poses;
};

void PrintTo(const CloseBy& close_by, std::ostream* out) { *out << close_by.name; }

class FromCloseBy : public ::testing::TestWithParam<CloseBy> {};
INSTANTIATE_TEST_SUITE_P(
    Boards, FromCloseBy,
    ::testing::Values(
        CloseBy{"Charuco", "charuco:5x7:35mm:26mm:DICT_5X5_100", "fisheye", {0.6, 0.9, 40}},
        CloseBy{"Legacy", "charuco:7x6:30mm:20mm:DICT_6X6_250:legacy", "fisheye", {0.6, 0.9, 40}},
        CloseBy{"AprilGrid", "aprilgrid:4x3:40mm:0.3", "fisheye", {0.6, 0.9, 40}},
        CloseBy{"Puzzle", "puzzle:6x5:30mm", "fisheye", {0.6, 0.9, 40}},
        CloseBy{"Squares", "checkerboard:7x6:25mm", "fisheye", {0.6, 0.9, 40}},
        CloseBy{"SmallCharuco", "charuco:4x4:35mm:26mm:DICT_4X4_50", "mild", {0.35, 0.6, 60}},
        CloseBy{"SmallSquares", "checkerboard:4x3:35mm", "mild", {0.35, 0.6, 60}},
        CloseBy{"Dots", "dots:9x7:20mm:rings=2.2+6.2+2.4", "fisheye", {0.5, 0.95, 40}},
        CloseBy{"Circles", "acircles:4x11:20mm", "fisheye", {0.5, 0.95, 40}}),
    [](const auto& test) { return std::string(test.param.name); });

// How many points of an observation that has one labelling are elsewhere than they are said to be.
int count_wrong(const Observation& seen, const Observation& truth) {
  constexpr double kFar = 2;  // px
  if (!seen.ambiguous.empty()) return 0;
  int wrong = 0;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const Pixel at = truth.uv[static_cast<std::size_t>(seen.ids[i])];
    wrong += std::hypot(seen.uv[i].u - at.u, seen.uv[i].v - at.v) > kFar ? 1 : 0;
  }
  return wrong;
}

TEST_P(FromCloseBy, AreFound) {
  const CloseBy& close_by = GetParam();
  const Board board = parse_board(close_by.board).value();
  Pictures pictures(board, close_by.lens, 14);
  const auto detector = std::move(*make_detector(board));
  const int views = scenes::full_count() ? 300 : 25;
  int found = 0;
  int wrong = 0;
  for (int n = 0; n < views; ++n) {
    const Picture picture = pictures.next(close_by.poses);
    const Observation seen = detector->detect(picture.image.view()).observation;
    found += seen.found() ? 1 : 0;
    wrong += count_wrong(seen, picture.truth);
  }
  std::cout << "  " << found << " of " << views << ", " << wrong << " points wrong\n";
  EXPECT_GE(found, views * 9 / 10);
  EXPECT_EQ(wrong, 0);
}

// A board that nobody asked for is named by the markers between its corners: those outside of them
// are misread where the lens bends much.
TEST(BoardsFromCloseBy, AreNamed) {
  for (const char* text :
       {"charuco:5x7:25mm:18.5mm:DICT_5X5_50", "charuco:7x6:25mm:16.75mm:DICT_6X6_50:legacy"}) {
    const Board board = parse_board(text).value();
    const auto* charuco = board.as<CharucoBoard>();
    Pictures pictures(board, "fisheye", 9);
    const int views = scenes::full_count() ? 60 : 12;
    int named = 0;
    for (int n = 0; n < views; ++n) {
      const Picture picture = pictures.next({0.4, 0.8, 40});
      const auto all = identify_boards(picture.image.view(), charuco->square);
      const auto* seen = all.empty() ? nullptr : all.front().board.as<CharucoBoard>();
      named += seen != nullptr && seen->cols == charuco->cols && seen->rows == charuco->rows &&
                       seen->legacy == charuco->legacy && seen->dictionary == charuco->dictionary
                   ? 1
                   : 0;
    }
    std::cout << "  " << text << ": " << named << " of " << views << '\n';
    EXPECT_GE(named, views * 3 / 4) << text;
  }
}

}  // namespace
}  // namespace calvin
