// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Points in space that others measured, beside OpenCV.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calvin/io/point_rows.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {
namespace {

constexpr ImageSize kPicture = {1280, 1024};

View view_of(const std::vector<PointRow>& rows, const Board& board) {
  View view;
  view.board = board;
  view.observation.board = board.text();
  view.observation.image_size = kPicture;
  view.observation.ids = board.ids();
  for (const PointRow& row : rows) view.observation.uv.push_back(*row.seen);
  return view;
}

// OpenCV's rms for the same model. It takes points in space only with a camera to start from, which
// is ours, and with a principal point within the image: all is shifted into a larger one.
double opencv_rms(const std::vector<PointRow>& rows, const Calibration& ours) {
  constexpr double kShift = 2000;
  const cv::Size large(6000, 6000);
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> seen;
  for (const PointRow& row : rows) {
    points.emplace_back(static_cast<float>(row.point->x()), static_cast<float>(row.point->y()),
                        static_cast<float>(row.point->z()));
    seen.emplace_back(static_cast<float>(row.seen->u + kShift),
                      static_cast<float>(row.seen->v + kShift));
  }
  const auto value = [&ours](const char* name) { return ours.find(name)->value; };
  cv::Mat k = (cv::Mat_<double>(3, 3) << value("fx"), 0, value("cx") + kShift, 0, value("fy"),
               value("cy") + kShift, 0, 0, 1);
  cv::Mat distortion =
      (cv::Mat_<double>(1, 5) << value("k1"), value("k2"), value("p1"), value("p2"), value("k3"));
  std::vector<cv::Mat> r;
  std::vector<cv::Mat> t;
  return cv::calibrateCamera(std::vector<std::vector<cv::Point3f>>{points},
                             std::vector<std::vector<cv::Point2f>>{seen}, large, k, distortion, r,
                             t, cv::CALIB_USE_INTRINSIC_GUESS,
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-12});
}

class Plate : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Cameras, Plate, ::testing::Values(1, 2, 3));

// A plate of several levels, seen once by each of three cameras.
TEST_P(Plate, IsFittedNoWorseThanByOpenCv) {
  const char* data = std::getenv("CALVIN_DATA");
  const std::filesystem::path folder =
      std::filesystem::path(data != nullptr ? data : "") / "points3d-myptv";
  if (data == nullptr || !std::filesystem::exists(folder)) {
    GTEST_SKIP() << "CALVIN_DATA does not name a folder with points3d-myptv";
  }
  const auto path = folder / ("cam" + std::to_string(GetParam()) + "_cal_points");
  const auto rows = read_point_rows(path, {parse_point_columns("u,v,X,Y,Z").value(), 1e-3});
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_GT(rows->size(), 400u);
  const Board board = board_of_rows(*rows, "plate").value();
  for (const char* method : {"", "dlt", "tsai"}) {
    SolveOptions options;
    options.method = method;
    options.reject_outliers = false;
    const auto found = solve(std::vector{view_of(*rows, board)}, kPicture, options);
    ASSERT_TRUE(found) << method << ": " << found.error().message;
    const double peer = opencv_rms(*rows, found->calibration);
    EXPECT_LE(*found->calibration.rms, 1.0001 * peer) << method;
    RecordProperty(std::string("rms_") + method, std::to_string(*found->calibration.rms));
  }
}

}  // namespace
}  // namespace calvin
