// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The same optimum as OpenCV's, for every model that it has, iterated to its end.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "plain_options.hpp"
#include "scenes.hpp"
#include "strong_lens.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

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
      board.emplace_back(static_cast<float>(std::lround(p.x() / view.board.cell_size(0))),
                         static_cast<float>(std::lround(p.y() / view.board.cell_size(0))), 0.0F);
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

struct OpenCvFit {
  std::vector<double> parameters;
  double cost = 0;  // px^2
};

const cv::TermCriteria kConverged(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 1000, 1e-15);

const std::map<std::string_view, int> kFlags = {
    {"brown4", cv::CALIB_FIX_K3},
    {"brown5", 0},
    {"rational8", cv::CALIB_RATIONAL_MODEL},
    {"thinprism12", cv::CALIB_RATIONAL_MODEL + cv::CALIB_THIN_PRISM_MODEL},
    {"tilted14", cv::CALIB_RATIONAL_MODEL + cv::CALIB_THIN_PRISM_MODEL + cv::CALIB_TILTED_MODEL},
};

// From the truth: its own start often ends in another basin for wide lenses.
OpenCvFit opencv_fit(std::string_view model, const Corners& corners, const Camera& truth) {
  const auto& p = truth.parameters();
  const cv::Size size(kSize.width, kSize.height);
  cv::Mat k = (cv::Mat_<double>(3, 3) << p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1);
  cv::Mat d(static_cast<int>(p.size()) - 4, 1, CV_64F);
  std::copy(p.begin() + 4, p.end(), d.ptr<double>());
  std::vector<cv::Mat> r;
  std::vector<cv::Mat> t;
  double rms = 0;
  if (model == "fisheye") {
    rms = cv::fisheye::calibrate(corners.board, corners.image, size, k, d, r, t,
                                 cv::fisheye::CALIB_USE_INTRINSIC_GUESS |
                                     cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC |
                                     cv::fisheye::CALIB_FIX_SKEW,
                                 kConverged);
  } else {
    rms = cv::calibrateCamera(corners.board, corners.image, size, k, d, r, t,
                              kFlags.at(model) | cv::CALIB_USE_LU | cv::CALIB_USE_INTRINSIC_GUESS,
                              kConverged);
  }
  OpenCvFit fit;
  fit.parameters = {k.at<double>(0, 0), k.at<double>(1, 1), k.at<double>(0, 2), k.at<double>(1, 2)};
  for (std::size_t i = 4; i < p.size(); ++i) {
    fit.parameters.push_back(d.at<double>(static_cast<int>(i) - 4));
  }
  fit.cost = rms * rms * static_cast<double>(corners.image.size() * corners.image[0].size());
  return fit;
}

// OpenCV's fisheye knows the tangent of the angle only: all corners are under 85 degrees.
bool all_ahead(const SE3& camera_from_board) {
  const double least = std::cos(85 * std::numbers::pi / 180);
  const auto points = kBoard.points();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d at = camera_from_board * p;
    return at.z() > least * at.norm();
  });
}

// Less noise than real corners have keeps weak coefficients where the problem has one basin.
constexpr double kSigma = 0.02;  // px

class OpenCv : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Peers, OpenCv,
                         ::testing::Values("brown4", "brown5", "rational8", "thinprism12",
                                           "tilted14", "fisheye"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(OpenCv, HasItsOptimumInTheSamePlace) {
  Random random(21);
  const int trials = scenes::full_count() ? 10 : 1;
  for (int i = 0; i < trials; ++i) {
    const Camera camera = scenes::strong_camera(GetParam(), random);
    std::vector<SE3> poses;
    while (poses.size() < 12) {
      const SE3 pose = scenes::random_pose(camera, kBoard, random, scenes::uniform(random, 0, 0.6));
      if (all_ahead(pose)) poses.push_back(pose);
    }
    auto views = scenes::observe_all(camera, kBoard, poses, kSigma, random);
    const Corners corners = to_opencv(views);
    const auto ours = solve(views, kSize, scenes::plain_options(GetParam()));
    ASSERT_TRUE(ours.has_value()) << ours.error().message;
    const Calibration& c = ours->calibration;
    const OpenCvFit theirs = opencv_fit(GetParam(), corners, camera);
    const double cost = *c.rms * *c.rms * static_cast<double>(views.size()) * 54;
    EXPECT_NEAR(theirs.cost / cost, 1, 1e-10);
    for (std::size_t k = 0; k < theirs.parameters.size(); ++k) {
      const Parameter& p = c.parameters[k];
      EXPECT_NEAR((p.value - theirs.parameters[k]) / *p.sigma, 0, 1e-4)
          << p.name << ", sigma " << *p.sigma;
    }
  }
}

}  // namespace
}  // namespace calvin
