// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The solve against other people's: OpenCV on the same corners, and Zhang's published result.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "calvin/solve/points.hpp"
#include "calvin/solve/solve_points.hpp"
#include "calvin_config.h"
#include "scenes.hpp"

#if CALVIN_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#endif

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

#if CALVIN_HAVE_OPENCV

struct Corners {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
};

// OpenCV computes in double but takes float corners: both sides get the rounded ones.
Corners to_opencv(std::vector<View>& views) {
  Corners corners;
  for (View& view : views) {
    std::vector<cv::Point3f> board;
    std::vector<cv::Point2f> image;
    // In units of a square: 0.025 is no float.
    for (const Eigen::Vector3d& p : view.board.points()) {
      board.emplace_back(static_cast<float>(std::lround(p.x() / view.board.size)),
                         static_cast<float>(std::lround(p.y() / view.board.size)), 0.0F);
    }
    for (Pixel& p : view.observation.uv) {
      image.emplace_back(static_cast<float>(p.u), static_cast<float>(p.v));
      p = {image.back().x, image.back().y};
    }
    corners.board.push_back(board);
    corners.image.push_back(image);
  }
  return corners;
}

const cv::TermCriteria kConverged(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 500, 1e-15);

std::vector<double> opencv_brown(const Corners& corners, bool with_k3) {
  cv::Mat k;
  cv::Mat d;
  std::vector<cv::Mat> r;
  std::vector<cv::Mat> t;
  cv::calibrateCamera(corners.board, corners.image, {kSize.width, kSize.height}, k, d, r, t,
                      (with_k3 ? 0 : cv::CALIB_FIX_K3) | cv::CALIB_USE_LU, kConverged);
  std::vector<double> p = {k.at<double>(0, 0), k.at<double>(1, 1), k.at<double>(0, 2),
                           k.at<double>(1, 2)};
  for (int i = 0; i < (with_k3 ? 5 : 4); ++i) p.push_back(d.at<double>(i));
  return p;
}

// Its own start ends in another valley more often than not: it is given the truth.
std::vector<double> opencv_fisheye(const Corners& corners, const Camera& truth) {
  const auto& p = truth.parameters();
  cv::Mat k = (cv::Mat_<double>(3, 3) << p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1);
  cv::Mat d = (cv::Mat_<double>(4, 1) << p[4], p[5], p[6], p[7]);
  std::vector<cv::Mat> r;
  std::vector<cv::Mat> t;
  cv::fisheye::calibrate(corners.board, corners.image, {kSize.width, kSize.height}, k, d, r, t,
                         cv::fisheye::CALIB_USE_INTRINSIC_GUESS |
                             cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW,
                         kConverged);
  return {k.at<double>(0, 0), k.at<double>(1, 1), k.at<double>(0, 2), k.at<double>(1, 2),
          d.at<double>(0),    d.at<double>(1),    d.at<double>(2),    d.at<double>(3)};
}

// OpenCV's fisheye knows the tangent of the angle only: no point may be near 90 degrees.
bool all_ahead(const SE3& camera_from_board) {
  const auto points = kBoard.points();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d at = camera_from_board * p;
    return at.z() > 0.3 * at.norm();
  });
}

class OpenCv : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Peers, OpenCv, ::testing::Values("brown4", "brown5", "fisheye"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(OpenCv, HasItsOptimumInTheSamePlace) {
  Random random(21);
  const int trials = scenes::full_count() ? 10 : 2;
  for (int i = 0; i < trials; ++i) {
    const Camera camera = scenes::random_camera(GetParam(), random);
    std::vector<SE3> poses;
    while (poses.size() < 10) {
      const SE3 pose = scenes::random_pose(camera, kBoard, random, scenes::uniform(random, 0, 0.6));
      if (all_ahead(pose)) poses.push_back(pose);
    }
    auto views = scenes::observe_all(camera, kBoard, poses, 0.1, random);
    const Corners corners = to_opencv(views);
    SolveOptions options;
    options.model = GetParam();
    options.reject_outliers = false;
    const auto ours = solve(views, kSize, options);
    ASSERT_TRUE(ours.has_value()) << ours.error().message;
    const auto theirs = GetParam() == "fisheye" ? opencv_fisheye(corners, camera)
                                                : opencv_brown(corners, GetParam() == "brown5");
    for (std::size_t k = 0; k < theirs.size(); ++k) {
      const Parameter& p = ours->calibration.parameters[k];
      EXPECT_NEAR(p.value, theirs[k], 1e-3 * *p.sigma) << p.name << ", sigma " << *p.sigma;
    }
  }
}

#endif

// The five views of a plane with 64 squares, in inches.
std::vector<PointSet> read_zhang(const std::filesystem::path& folder) {
  const auto read = [&folder](const std::string& name) {
    std::ifstream file(folder / name);
    file.imbue(std::locale::classic());
    std::vector<double> numbers;
    for (double x; file >> x;) numbers.push_back(x);
    return numbers;
  };
  const auto model = read("Model.txt");
  std::vector<PointSet> views;
  for (int v = 1; v <= 5; ++v) {
    const auto data = read("data" + std::to_string(v) + ".txt");
    PointSet view;
    view.index = static_cast<std::size_t>(v - 1);
    for (std::size_t i = 0; i + 1 < std::min(model.size(), data.size()); i += 2) {
      view.ids.push_back(static_cast<int>(i / 2));
      view.points.emplace_back(model[i], model[i + 1], 0);
      view.uv.push_back({data[i], data[i + 1]});
      view.weight.push_back(1);
    }
    views.push_back(std::move(view));
  }
  return views;
}

TEST(Zhang, PublishedResultIsReproduced) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder = std::filesystem::path(data == nullptr ? "" : data) / "zhang";
  if (data == nullptr || !std::filesystem::exists(folder / "Model.txt")) {
    GTEST_SKIP() << "CALVIN_DATA does not name a folder with zhang/Model.txt";
  }
  auto views = read_zhang(folder);
  ASSERT_EQ(views[4].size(), 256u);
  SolveOptions options;
  options.model = "brown4";
  options.fix = {"p1", "p2"};
  options.reject_outliers = false;
  const auto solution = solve_points(std::move(views), {}, {640, 480}, options);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  const Calibration& c = solution->calibration;
  // Published with a skew of 0.2 px, which is not estimated here.
  EXPECT_NEAR(c.find("fx")->value, 832.5, 0.6);
  EXPECT_NEAR(c.find("fy")->value, 832.53, 0.6);
  EXPECT_NEAR(c.find("cx")->value, 303.959, 0.6);
  EXPECT_NEAR(c.find("cy")->value, 206.585, 0.6);
  EXPECT_NEAR(c.find("k1")->value, -0.228601, 0.002);
  EXPECT_NEAR(c.find("k2")->value, 0.190353, 0.005);
  EXPECT_NEAR(*c.rms, 0.336, 0.002);
}

}  // namespace
}  // namespace calvin
