// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures of boards of discs that others took or rendered: beside OpenCV's detector none of them
// shows less, and the cameras that they make are those that are known.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calvin/detect/detector.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {
namespace {

struct Set {
  const char* folder;
  const char* extension;
  const char* board;
  std::size_t pictures;  // all of them show the board
  int discs;             // at least, in all of them
};

// The views of a set; a test is skipped where it is not there.
class RealCircles : public ::testing::Test {
 protected:
  void read(const Set& set) {
    const char* all = std::getenv("CALVIN_DATA");
    const auto folder = std::filesystem::path(all == nullptr ? "" : all) / set.folder;
    if (!std::filesystem::is_directory(folder)) {
      GTEST_SKIP() << "CALVIN_DATA names no folder with " << set.folder;
    }
    const Board board = parse_board(set.board).value();
    const auto detector = make_detector(board).value();
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == set.extension) files.push_back(entry.path());
    }
    std::ranges::sort(files);
    int discs = 0;
    for (const auto& file : files) {
      images_.push_back(cv::imread(file.string(), cv::IMREAD_GRAYSCALE));
      const cv::Mat& m = images_.back();
      Observation seen =
          detector->detect({m.data, m.cols, m.rows, static_cast<std::ptrdiff_t>(m.step[0]), 1})
              .observation;
      EXPECT_TRUE(seen.found()) << file;
      discs += static_cast<int>(seen.ids.size());
      seen.timestamp = images_.size();
      size_ = seen.image_size;
      if (seen.found()) views_.push_back({.observation = std::move(seen), .board = board});
    }
    EXPECT_EQ(views_.size(), set.pictures);
    EXPECT_GE(discs, set.discs);
  }

  std::vector<cv::Mat> images_;
  std::vector<View> views_;
  ImageSize size_;
};

// A photograph of small discs, of which one is larger. OpenCV sees the same grid with a blob
// detector tuned to it.
TEST_F(RealCircles, WithALargerOneAreFoundInAllPictures) {
  read({"circles-rct10x10", ".png", "dots:10x10:25.4mm:big=0.0", 8, 796});
  if (IsSkipped()) return;
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> centres;
  cv::SimpleBlobDetector::Params blobs;
  blobs.minArea = 20;
  blobs.minDistBetweenBlobs = 4;
  blobs.filterByInertia = blobs.filterByConvexity = false;
  const auto finder = cv::SimpleBlobDetector::create(blobs);
  for (const cv::Mat& image : images_) {
    std::vector<cv::Point2f> found;
    if (!cv::findCirclesGrid(image, {10, 10}, found, cv::CALIB_CB_SYMMETRIC_GRID, finder)) continue;
    centres.push_back(found);
    points.emplace_back();
    for (int i = 0; i < 100; ++i) {
      points.back().emplace_back(0.0254F * static_cast<float>(i % 10),
                                 0.0254F * static_cast<float>(i / 10), 0.0F);
    }
  }
  ASSERT_GE(centres.size(), 4U);
  cv::Mat k;
  cv::Mat distortion;
  std::vector<cv::Mat> r;
  std::vector<cv::Mat> t;
  const double theirs = cv::calibrateCamera(points, centres, images_.front().size(), k, distortion,
                                            r, t, cv::CALIB_FIX_K3);
  SolveOptions options;
  options.model = "brown4";
  const auto ours = solve(views_, size_, options);
  ASSERT_TRUE(ours) << ours.error().message;
  std::cout << "  RMS " << ours->calibration.rms.value() << " px, of OpenCV's centres " << theirs
            << " px (" << centres.size() << " pictures)\n";
  EXPECT_LT(ours->calibration.rms.value(), theirs);
}

TEST_F(RealCircles, OfAnAsymmetricGridAreFoundInAllPictures) {
  read({"circles-asym-lorenzi", ".png", "acircles:4x11:20mm", 4, 170});
}

// Light on dark, three rings that name parts of the board. The camera is that of the set's
// checkerboards: fx 6673.3.
TEST_F(RealCircles, WithRingsMakeTheCameraThatTheyWereRenderedWith) {
  read({"dice-white-dots", ".jpeg", "dots:14x10:7mm:rings=2.2+2.7+11.7:inverted", 11, 1400});
  if (IsSkipped()) return;
  const auto solution = solve(views_, size_);
  ASSERT_TRUE(solution) << solution.error().message;
  const Parameter& fx = solution->calibration.parameters[0];
  std::cout << "  fx " << fx.value << " +- " << fx.sigma.value_or(-1) << ", RMS "
            << solution->calibration.rms.value() << " px, promise "
            << solution->calibration.chi.value_or(-1) << "\n";
  constexpr double kOthers = 1.5;  // px, how far the makers of the set are from it
  EXPECT_LT(std::abs(fx.value - 6673.3), 3 * std::hypot(fx.sigma.value(), kOthers));
}

}  // namespace
}  // namespace calvin
