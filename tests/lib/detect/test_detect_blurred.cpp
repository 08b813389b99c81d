// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards of markers so far away, or so far out of focus, that hardly a bit of a marker can be told
// by itself: all markers together tell where the board lies, and tell no other board.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "calvin/detect/checkerboard/code/markers/marker_ink.hpp"
#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/target/marker_dictionary.hpp"
#include "detect_scenes.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

// Cells of markers of one pixel to one and a half, and cells as wide as the blur.
const bench::SceneClass kFar = {
    .name = "far away", .square_from = 11, .square_to = 15, .tilt = 0.4};
const bench::SceneClass kBlurred = {
    .name = "out of focus", .blur = 3.2, .square_from = 36, .square_to = 50};

// Where a part of the rows is in view, other boards lie over it in more ways.
const bench::SceneClass kCut = {
    .name = "out of frame", .fill_from = 0.7, .fill_to = 1.6, .cut = true};

constexpr ImageSize kSize = {1280, 720};

ImageView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1};
}

struct Score {
  int visible = 0;
  int named = 0;
  int wrong = 0;         // farther than a pixel and a half from their place
  double square = 0;     // px^2
  double predicted = 0;  // px^2

  void add(const Observation& truth, const Observation& seen) {
    visible += static_cast<int>(truth.ids.size());
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto at = std::ranges::find(truth.ids, seen.ids[i]) - truth.ids.begin();
      const auto own = static_cast<std::size_t>(at);
      const double off = own < truth.ids.size() ? std::hypot(truth.uv[own].u - seen.uv[i].u,
                                                             truth.uv[own].v - seen.uv[i].v)
                                                : 1e9;
      wrong += off > 1.5 ? 1 : 0;
      if (off > 1.5) continue;
      ++named;
      square += off * off;
      predicted += 2 * seen.sigma[i] * seen.sigma[i];
    }
  }
};

class BlurredMarkers : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  }
};

TEST_F(BlurredMarkers, NameTheBoard) {
  const int pictures = scenes::full_count() ? 60 : 8;
  for (const char* text : {"charuco:8x6:40mm:30mm:DICT_5X5_100",
                           "charuco:7x8:40mm:30mm:DICT_6X6_250:legacy", "aprilgrid:5x4:88mm:0.3"}) {
    const auto detector = make_detector(parse_board(text).value()).value();
    for (bench::SceneClass kind : {kFar, kBlurred}) {
      kind.board = text;
      Score score;
      for (int i = 0; i < pictures; ++i) {
        const auto scene = bench::make_scene(kind, kSize, 700 + static_cast<std::uint64_t>(i));
        score.add(scene.truth, detector->detect(view_of(scene.image)).observation);
      }
      const double share = static_cast<double>(score.named) / score.visible;
      const double predicted = std::sqrt(score.predicted / score.square);
      std::cout << text << ", " << kind.name << ": " << 100 * share << " % named, " << score.wrong
                << " wrong, predicted over real " << predicted << "\n";
      EXPECT_GE(share, 0.9) << text << ", " << kind.name;
      EXPECT_EQ(score.wrong, 0) << text << ", " << kind.name;
      // A marker's edges are a pixel or two away, and are in the window in part.
      EXPECT_GT(predicted, 0.6) << text << ", " << kind.name;
      EXPECT_LT(predicted, 2) << text << ", " << kind.name;
    }
  }
}

// What blur takes of a marker's edges into the window of a corner is no noise of the corner: of
// squares of 35 px, markers are four pixels away.
TEST_F(BlurredMarkers, AreNoNoiseOfCorners) {
  const int pictures = scenes::full_count() ? 60 : 8;
  for (const char* text :
       {"charuco:8x6:40mm:30mm:DICT_5X5_100", "charuco:9x7:40mm:32mm:DICT_4X4_100"}) {
    const auto detector = make_detector(parse_board(text).value()).value();
    const bench::SceneClass kind{
        .name = "35 px squares", .board = text, .square_from = 33, .square_to = 37, .tilt = 0.35};
    Score score;
    for (int i = 0; i < pictures; ++i) {
      const auto scene = bench::make_scene(kind, kSize, 300 + static_cast<std::uint64_t>(i));
      score.add(scene.truth, detector->detect(view_of(scene.image)).observation);
    }
    EXPECT_EQ(score.named, score.visible) << text;
    const double predicted = std::sqrt(score.predicted / score.square);
    EXPECT_GT(predicted, 0.8) << text;
    EXPECT_LT(predicted, 1.25) << text;
  }
}

// So much blur leaves no marker to be seen beside the corners: they are those of a plain
// checkerboard.
TEST_F(BlurredMarkers, HideNoCorners) {
  const int pictures = scenes::full_count() ? 60 : 8;
  const bench::SceneClass far = {
      .name = "far and out of focus", .blur = 3.3, .square_from = 22, .square_to = 28, .tilt = 0.3};
  for (const char* text :
       {"charuco:8x6:40mm:30mm:DICT_5X5_100", "charuco:7x8:40mm:30mm:DICT_6X6_250:legacy"}) {
    const auto detector = make_detector(parse_board(text).value()).value();
    bench::SceneClass kind = far;
    kind.board = text;
    Score score;
    for (int i = 0; i < pictures; ++i) {
      const auto scene = bench::make_scene(kind, kSize, 1100 + static_cast<std::uint64_t>(i));
      score.add(scene.truth, detector->detect(view_of(scene.image)).observation);
    }
    const double share = static_cast<double>(score.named) / score.visible;
    std::cout << text << ", " << kind.name << ": " << 100 * share << " % named, " << score.wrong
              << " wrong, RMS " << std::sqrt(score.square / score.named)
              << " px, predicted over real " << std::sqrt(score.predicted / score.square) << "\n";
    EXPECT_GE(share, 0.9) << text;
    EXPECT_EQ(score.wrong, 0) << text;
    EXPECT_LT(std::sqrt(score.square / score.named), 0.1) << text;
  }
}

// Without its markers, a ChArUco board is the checkerboard of its squares: to less than a hundredth
// of what the markers take from it.
TEST_F(BlurredMarkers, AreTakenOutOfThePicture) {
  const int pictures = scenes::full_count() ? 30 : 4;
  const float width = std::sqrt(3.2F * 3.2F + 1.0F / 12);  // px, that of pixels included
  const detect::Pattern pattern(parse_board("charuco:8x6:40mm:30mm:DICT_5X5_100").value());
  const Grid& grid = pattern.grid;
  detect::MarkerInk ink;
  for (int i = 0; i < pictures; ++i) {
    const auto picture_of = [&](const char* board) {
      bench::SceneClass kind = kBlurred;
      kind.board = board;
      return bench::make_scene(kind, kSize, 500 + static_cast<std::uint64_t>(i));
    };
    const auto shown = picture_of("charuco:8x6:40mm:30mm:DICT_5X5_100");
    const auto plain = picture_of("checkerboard:7x5:40mm");
    detect::Lattice lattice(12, pattern.surroundings);
    for (std::size_t k = 0; k < shown.truth.ids.size(); ++k) {
      const GridPlace at = grid.place(shown.truth.ids[k]);
      detect::Node node;
      node.x = static_cast<float>(shown.truth.uv[k].u);
      node.y = static_cast<float>(shown.truth.uv[k].v);
      lattice.put({at.col + 1, at.row}, node);
    }
    const ImageView left = ink.taken_off(view_of(shown.image), *pattern.code,
                                         {0, {1, 0}, grid.cols, grid.rows}, lattice, width);
    // Noise averages out over some pixels.
    const auto difference = [&](const ImageView& image) {
      double squares = 0;
      int count = 0;
      constexpr int kSide = 8;  // px
      for (int y = 0; y + kSide <= image.height; y += kSide) {
        for (int x = 0; x + kSide <= image.width; x += kSide) {
          double sum = 0;
          for (int row = y; row < y + kSide; ++row) {
            for (int col = x; col < x + kSide; ++col) {
              sum += image.at(col, row) - plain.image.at<std::uint8_t>(row, col);
            }
          }
          squares += sum * sum;
          ++count;
        }
      }
      return std::sqrt(squares / count) / (kSide * kSide);
    };
    EXPECT_GT(difference(view_of(shown.image)), 5) << i;
    EXPECT_LT(difference(left), 0.01 * difference(view_of(shown.image))) << i;
  }
}

// Of a board with the same markers in another order, or in rows of another length, some lie as they
// do on the one that is looked for.
TEST_F(BlurredMarkers, TellNoOtherBoard) {
  const auto pictures_of = [](const bench::SceneClass& kind) {
    return scenes::full_count() ? 60 : kind.cut ? 20 : 3;
  };
  const std::pair<const char*, const char*> kPairs[] = {
      {"charuco:8x6:40mm:30mm:DICT_5X5_100", "charuco:8x6:40mm:30mm:DICT_5X5_100:legacy"},
      {"charuco:8x6:40mm:30mm:DICT_5X5_100:legacy", "charuco:8x6:40mm:30mm:DICT_5X5_100"},
      {"charuco:8x6:40mm:30mm:DICT_5X5_100", "charuco:9x7:40mm:30mm:DICT_5X5_100"},
      {"charuco:9x7:40mm:30mm:DICT_5X5_100", "charuco:8x6:40mm:30mm:DICT_5X5_100"},
      {"charuco:8x6:40mm:30mm:DICT_5X5_100", "charuco:8x6:40mm:30mm:DICT_4X4_100"},
      {"charuco:8x6:40mm:30mm:DICT_5X5_100", "checkerboard:7x5:40mm"},
      {"aprilgrid:5x4:88mm:0.3", "aprilgrid:5x4:88mm:0.3:first=20"},
      {"aprilgrid:5x4:88mm:0.3", "aprilgrid:4x5:88mm:0.3"}};
  for (const auto& [wanted, shown] : kPairs) {
    const auto detector = make_detector(parse_board(wanted).value()).value();
    for (bench::SceneClass kind : {kFar, kBlurred, kCut, bench::SceneClass{.name = "plain"}}) {
      kind.board = shown;
      for (int i = 0; i < pictures_of(kind); ++i) {
        const auto scene = bench::make_scene(kind, kSize, 900 + static_cast<std::uint64_t>(i));
        EXPECT_FALSE(detector->detect(view_of(scene.image)).observation.found())
            << shown << " as " << wanted << ", " << kind.name << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace calvin
