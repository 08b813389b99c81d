// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Photographs of boards with a code: beside OpenCV's detectors of ChArUco boards and of AprilTags
// none of them shows less.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calvin/detect/detector.hpp"
#include "calvin/detect/identify.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/target/marker_dictionary.hpp"

namespace calvin {
namespace {

// Empty where it is not there.
std::filesystem::path real_data(const char* name) {
  const char* all = std::getenv("CALVIN_DATA");
  const auto folder = std::filesystem::path(all == nullptr ? "" : all) / name;
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

std::vector<std::filesystem::path> pictures_of(const std::filesystem::path& folder,
                                               const std::string& extension) {
  std::vector<std::filesystem::path> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == extension) all.push_back(entry.path());
  }
  std::ranges::sort(all);
  return all;
}

Observation seen_in(Detector& detector, const cv::Mat& image) {
  return detector
      .detect({image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1})
      .observation;
}
Observation seen_in(Detector& detector, const std::filesystem::path& picture) {
  return seen_in(detector, cv::imread(picture.string(), cv::IMREAD_GRAYSCALE));
}

struct Set {
  const char* name;
  const char* folder;
  const char* board;
  int pictures;    // on which the board is found
  int corners;     // what OpenCV 4.6 finds in all
  double rms;      // px, what a calibration of OpenCV's corners has
  double blurred;  // of the corners those that are named with a blur of 4 px, at least
};

class RealCharuco : public ::testing::TestWithParam<Set> {};
constexpr Set kSets[] = {
    {"New", "charuco-photonvision-1280", "charuco:8x8:25.4mm:19.05mm:DICT_4X4_1000", 16, 749, 0.255,
     0.98},
    {"Legacy", "charuco-photonvision-legacy-480", "charuco:8x8:25.4mm:19.05mm:DICT_4X4_1000:legacy",
     16, 713, 0, 0.93},
    {"Covered", "charuco-rct-small", "charuco:5x7:40mm:20mm:DICT_6X6_250", 2, 24 + 19, 0, 0.5},
};
INSTANTIATE_TEST_SUITE_P(Sets, RealCharuco, ::testing::ValuesIn(kSets),
                         [](const auto& test) { return test.param.name; });

TEST_P(RealCharuco, IsFoundAsOftenAsByOpenCv) {
  const Set& set = GetParam();
  const auto folder = real_data(set.folder);
  if (folder.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no " << set.folder;
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Board board = parse_board(set.board).value();
  const auto detector = make_detector(board).value();
  std::vector<View> views;
  int corners = 0;
  ImageSize size;
  for (const auto& picture : pictures_of(folder, ".jpg")) {
    const Observation seen = seen_in(*detector, picture);
    if (!seen.found()) continue;
    corners += static_cast<int>(seen.ids.size());
    size = seen.image_size;
    views.push_back({.observation = seen, .board = board});
  }
  EXPECT_EQ(static_cast<int>(views.size()), set.pictures);
  EXPECT_GE(corners, set.corners);
  if (set.rms == 0) return;
  // Names that are wrong would not fit a camera.
  SolveOptions options;
  options.model = "brown5";
  const auto solution = solve(views, size, options);
  ASSERT_TRUE(solution) << solution.error().message;
  EXPECT_LT(solution->calibration.rms, set.rms);
}

// The same pictures out of focus: corners have the names that they have in the sharp ones.
TEST_P(RealCharuco, IsNamedOutOfFocus) {
  const Set& set = GetParam();
  const auto folder = real_data(set.folder);
  if (folder.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no " << set.folder;
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const auto detector = make_detector(parse_board(set.board).value()).value();
  std::size_t corners = 0;
  std::size_t named = 0;
  for (const auto& picture : pictures_of(folder, ".jpg")) {
    const cv::Mat image = cv::imread(picture.string(), cv::IMREAD_GRAYSCALE);
    cv::Mat blurred;
    cv::GaussianBlur(image, blurred, {0, 0}, 4);
    const Observation sharp = seen_in(*detector, image);
    const Observation seen = seen_in(*detector, blurred);
    corners += sharp.ids.size();
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto own = std::ranges::find(sharp.ids, seen.ids[i]);
      if (own == sharp.ids.end()) continue;
      const Pixel& there = sharp.uv[static_cast<std::size_t>(own - sharp.ids.begin())];
      // Far less than a square.
      EXPECT_LT(std::hypot(seen.uv[i].u - there.u, seen.uv[i].v - there.v), 5) << picture;
      ++named;
    }
  }
  EXPECT_GE(static_cast<double>(named), set.blurred * static_cast<double>(corners));
}

// A sheet in the old order is none in the new one, though half of the markers are where they would
// be.
TEST(RealCharucoOrder, IsThatOfTheText) {
  const auto folder = real_data("charuco-photonvision-legacy-480");
  if (folder.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no such set";
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Board board = parse_board("charuco:8x8:25.4mm:19.05mm:DICT_4X4_1000").value();
  const auto detector = make_detector(board).value();
  for (const auto& picture : pictures_of(folder, ".jpg")) {
    EXPECT_FALSE(seen_in(*detector, picture).found()) << picture;
  }
}

struct AprilSet {
  const char* name;
  const char* folder;
  const char* extension;
  const char* board;
  int pictures;
};

class RealAprilGrid : public ::testing::TestWithParam<AprilSet> {};
constexpr AprilSet kAprilSets[] = {
    {"EurocAndTum", "aprilgrid-rs-images", ".png", "aprilgrid:6x6:88mm:0.3", 4},
    {"Phone", "aprilgrid-phone", ".jpg", "aprilgrid:6x6:88mm:0.3", 2},
    {"ThinBorders", "aprilgrid-phone", ".png", "aprilgrid:14x11:88mm:0.25:border=1", 1},
};
INSTANTIATE_TEST_SUITE_P(Sets, RealAprilGrid, ::testing::ValuesIn(kAprilSets),
                         [](const auto& test) { return test.param.name; });

// Tag 0 is at the lower left of a board that stands upright.
TEST_P(RealAprilGrid, IsFoundWholeInEveryPicture) {
  const AprilSet& set = GetParam();
  const auto folder = real_data(set.folder);
  if (folder.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no " << set.folder;
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Board board = parse_board(set.board).value();
  const auto detector = make_detector(board).value();
  const auto pictures = pictures_of(folder, set.extension);
  EXPECT_EQ(static_cast<int>(pictures.size()), set.pictures);
  for (const auto& picture : pictures) {
    const Observation seen = seen_in(*detector, picture);
    EXPECT_EQ(seen.ids, board.ids()) << picture;
  }
}

// The first corners of the map: a picture of the paper's authors.
TEST(RealPuzzleBoard, IsNamedWhereTheMapHasIt) {
  const auto folder = real_data("puzzleboard");
  if (folder.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no puzzleboard";
  const Board board = parse_board("puzzle:20x20:20mm").value();
  const auto detector = make_detector(board).value();
  const Observation seen = seen_in(*detector, folder / "example7.png");
  ASSERT_EQ(seen.ids.size(), 16U);
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const GridPlace place = board.grid()->place(seen.ids[i]);
    EXPECT_NEAR(seen.uv[i].u, 50 + 94.5 * place.col, 2);
    EXPECT_NEAR(seen.uv[i].v, 80 + 94.5 * place.row, 2);
  }
}

// The table and the sheet beside a checkerboard are no row of it.
TEST(RealCheckerboards, AreNamedBySize) {
  struct Pictures {
    const char* folder;
    const char* first;  // of their names
    const char* board;
    int least;  // that are named
  };
  for (const Pictures& set :
       {Pictures{"opencv-samples", "left", "checkerboard:9x6:25mm", 13},
        {"opencv-samples", "right", "checkerboard:9x6:25mm", 12},
        {"photonvision-gloworm_960_720", "img", "checkerboard:8x6:25mm", 10}}) {
    const auto folder = real_data(set.folder);
    if (folder.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no " << set.folder;
    int named = 0;
    for (const auto& picture : pictures_of(folder, ".jpg")) {
      if (!picture.filename().string().starts_with(set.first)) continue;
      const cv::Mat image = cv::imread(picture.string(), cv::IMREAD_GRAYSCALE);
      const auto seen = identify_boards(
          {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1},
          0.025);
      for (const IdentifiedBoard& one : seen) {
        EXPECT_TRUE(!one.whole || one.board.text() == set.board) << picture << one.board.text();
        named += one.board.text() == set.board ? 1 : 0;
      }
    }
    EXPECT_GE(named, set.least) << set.folder << " " << set.first;
  }
}

}  // namespace
}  // namespace calvin
