// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards that the border of the picture or a card cuts off: the corners at the ends of lines, with
// one other corner beside them, are named as all others are, and where they are.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/render.hpp"
#include "detect_scenes.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

namespace fs = std::filesystem;

// Whether a corner is at the end of a line: of the corners beside it only one is there.
bool is_end(const Board& board, const std::set<int>& there, int id) {
  const std::vector<int> beside = board.neighbours(id);
  return std::ranges::count_if(beside, [&](int n) { return there.count(n) > 0; }) == 1;
}

ImageView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1};
}

struct Ends {
  int seen = 0;
  int named = 0;
  double error = 0;  // px^2, sums over those that are named
  double sigma = 0;

  // Those of a view through which the border goes, `margin` px from it or farther.
  void add(const Board& board, const Observation& truth, const Observation& found, double margin) {
    const ImageSize size = found.image_size;
    const auto is_inside = [&](const Pixel& p) {
      return p.u > margin && p.v > margin && p.u < size.width - 1 - margin &&
             p.v < size.height - 1 - margin;
    };
    std::set<int> in_view;
    for (std::size_t i = 0; i < truth.ids.size(); ++i) {
      if (is_inside(truth.uv[i])) in_view.insert(truth.ids[i]);
    }
    for (std::size_t i = 0; i < truth.ids.size(); ++i) {
      if (in_view.count(truth.ids[i]) == 0 || !is_end(board, in_view, truth.ids[i])) continue;
      ++seen;
      const auto at = std::ranges::find(found.ids, truth.ids[i]);
      if (at == found.ids.end()) continue;
      ++named;
      const auto k = static_cast<std::size_t>(at - found.ids.begin());
      const double du = found.uv[k].u - truth.uv[i].u;
      const double dv = found.uv[k].v - truth.uv[i].v;
      EXPECT_LT(std::hypot(du, dv), 0.1) << truth.ids[i];
      error += du * du + dv * dv;
      sigma += 2 * found.sigma[k] * found.sigma[k];
    }
  }
};

struct Cut {
  const char* name;
  const char* board;
};
class CutCodes : public ::testing::TestWithParam<Cut> {};
INSTANTIATE_TEST_SUITE_P(Boards, CutCodes,
                         ::testing::Values(Cut{"Charuco", "charuco:8x6:40mm:30mm:DICT_5X5_100"},
                                           Cut{"Puzzle", "puzzle:14x9:20mm"}),
                         [](const auto& cut) { return cut.param.name; });

TEST_P(CutCodes, ShowTheEndsOfTheirLines) {
  const auto board = parse_board(GetParam().board);
  if (!board) GTEST_SKIP() << board.error().message;
  const auto detector = make_detector(*board).value();
  const auto classes = bench::scene_classes();
  bench::SceneClass kind = *std::ranges::find_if(classes, [](const auto& c) { return c.cut; });
  kind.board = GetParam().board;
  const int images = scenes::full_count() ? 200 : 16;
  Ends ends;
  for (int n = 0; n < images; ++n) {
    const auto scene = bench::make_scene(kind, {1280, 720}, 7000 + static_cast<std::uint64_t>(n));
    ends.add(*board, scene.truth, detector->detect(view_of(scene.image)).observation, 2);
  }
  const double predicted = std::sqrt(ends.sigma / std::max(ends.error, 1e-12));
  std::cout << "  " << ends.named << " of " << ends.seen << " ends of lines, predicted over real "
            << predicted << "\n";
  EXPECT_GE(ends.seen, images / 5);
  EXPECT_GE(ends.named, ends.seen * 97 / 100);
  EXPECT_GE(predicted, 0.75);
  EXPECT_LE(predicted, 1.6);
}

// In the corners of a wide picture edges bend, and at the end of a line that is cut off by how much
// is only half known: the sigmas contain it.
TEST(CutBoards, TellHowUncertainTheEndsOfTheirLinesAre) {
  const auto board = parse_board("charuco:8x6:40mm:30mm:DICT_5X5_100");
  if (!board) GTEST_SKIP() << board.error().message;
  const auto detector = make_detector(*board).value();
  const Camera camera = default_camera({960, 720});
  const BoardRenderer renderer(camera);
  const Eigen::Vector3d middle(0.12, 0.08, 0);  // m
  scenes::Random random(8);
  Ends ends;
  for (int n = 0; n < 150; ++n) {
    const double square = scenes::uniform(random, 130, 190);  // px
    const double depth = camera.fx() * 0.04 / square;
    const double turn = scenes::uniform(random, 0, 2 * std::numbers::pi);
    const double tilt = scenes::uniform(random, -0.6, 0.6);
    const Eigen::Matrix3d rotation = exp_so3({0, 0, turn}) * exp_so3({tilt, 0, 0});
    const Eigen::Vector3d at(scenes::uniform(random, -0.35, 0.35) * depth,
                             scenes::uniform(random, -0.25, 0.25) * depth, depth);
    const SE3 pose = {rotation, at - rotation * middle};
    const auto image = renderer.render(
        *board, pose, {.noise = 2, .blur = 0.7, .seed = static_cast<std::uint64_t>(n)});
    const Observation truth = true_observation(camera, *board, pose);
    const Observation found = detector->detect(image.view()).observation;
    ends.add(*board, truth, found, 25);
  }
  const double predicted = std::sqrt(ends.sigma / std::max(ends.error, 1e-12));
  std::cout << "  " << ends.named << " of " << ends.seen << " ends of lines, predicted over real "
            << predicted << "\n";
  EXPECT_GE(ends.named, 15);
  EXPECT_GE(predicted, 0.8);
  EXPECT_LE(predicted, 2);
}

// A photograph, and what was seen in it.
struct Photograph {
  cv::Mat image;
  Observation seen;
};

std::vector<Photograph> photographs(const fs::path& folder, Detector& detector,
                                    std::size_t corners) {
  std::vector<Photograph> all;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const cv::Mat image = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
    if (image.empty()) continue;
    const Observation seen = detector
                                 .detect({image.data, image.cols, image.rows,
                                          static_cast<std::ptrdiff_t>(image.step[0]), 1})
                                 .observation;
    if (seen.ids.size() == corners) all.push_back({image, seen});
  }
  return all;
}

// A grey card over a part of the board.
void lay_card(const Observation& board, scenes::Random& random, cv::Mat& image) {
  std::vector<cv::Point2f> corners;
  for (const Pixel& p : board.uv) corners.emplace_back(cv::Point2d(p.u, p.v));
  const cv::RotatedRect around = cv::minAreaRect(corners);
  const float side = std::max(around.size.width, around.size.height);
  const auto number = [&](double low, double high) {
    return static_cast<float>(scenes::uniform(random, low, high));
  };
  const cv::Point2f middle = corners[static_cast<std::size_t>(
      scenes::uniform(random, 0, static_cast<double>(corners.size()) - 0.1))];
  const cv::RotatedRect card(middle, {number(0.1, 0.35) * side, number(0.3, 1) * side},
                             number(0, 180));
  cv::Point2f of_card[4];
  card.points(of_card);
  std::vector<cv::Point> polygon(of_card, of_card + 4);
  cv::fillConvexPoly(image, polygon, number(60, 200), cv::LINE_AA);
}

// Cards on photographs of a board on a screen: what is left of the board is where it was.
TEST(CoveredPhotographs, ShowTheEndsOfTheirLines) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder = fs::path(data == nullptr ? "" : data) / "charuco-photonvision-1280";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "without CALVIN_DATA there are no photographs";
  const auto board = parse_board("charuco:8x8:25.4mm:19.05mm:DICT_4X4_1000");
  if (!board) GTEST_SKIP() << board.error().message;
  const auto detector = make_detector(*board).value();
  scenes::Random random(4);
  int ends = 0;
  int corners = 0;
  for (const Photograph& of : photographs(folder, *detector, board->ids().size())) {
    for (int n = 0; n < 8; ++n) {
      cv::Mat image = of.image.clone();
      lay_card(of.seen, random, image);
      const Observation left = detector->detect(view_of(image)).observation;
      const std::set<int> ids(left.ids.begin(), left.ids.end());
      for (std::size_t i = 0; i < left.ids.size(); ++i) {
        if (!is_end(*board, ids, left.ids[i])) continue;
        ++ends;
        const Pixel& was = of.seen.uv[static_cast<std::size_t>(left.ids[i])];
        const double off = std::hypot(left.uv[i].u - was.u, left.uv[i].v - was.v);
        EXPECT_LT(off, 0.25) << left.ids[i];
      }
      corners += static_cast<int>(left.ids.size());
    }
  }
  std::cout << "  " << ends << " ends of lines among " << corners << " corners\n";
  EXPECT_GE(ends, 30);
}

// Sheets are bent, and corners at the border of a wide picture are less certain than those in its
// middle: they are corners all the same.
TEST(BentSheets, KeepTheirUncertainCorners) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto file = fs::path(data == nullptr ? "" : data) / "chess-carnd-lanes/calibration4.jpg";
  if (!fs::is_regular_file(file)) GTEST_SKIP() << "without CALVIN_DATA there is no photograph";
  const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  const auto detector = make_detector(Board(Checkerboard{9, 6, 0.03})).value();
  const Observation seen = detector->detect(view_of(image)).observation;
  EXPECT_EQ(seen.ids.size(), 54U);
}

}  // namespace
}  // namespace calvin
