// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rectification beside OpenCV's, and of a real pair of cameras.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calvin/rig/solve_rig.hpp"
#include "calvin/rig/stereo.hpp"
#include "calvin/solve/solve.hpp"
#include "real_sets.hpp"
#include "rectified_pair.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

cv::Mat to_cv(const Eigen::Matrix3d& m) {
  cv::Mat out(3, 3, CV_64F);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out.at<double>(r, c) = m(r, c);
  }
  return out;
}

// OpenCV takes the first camera for the left or upper one.
TEST(OpenCvRectification, TurnsTheCamerasAsFar) {
  const Camera camera = Camera::make("pinhole", {640, 480}, {600, 600, 319.5, 239.5}).value();
  for (int trial = 0; trial < 100; ++trial) {
    scenes::Random random(static_cast<std::uint64_t>(trial));
    const auto little = [&](double most) { return scenes::uniform(random, -most, most); };
    Eigen::Vector3d place(scenes::uniform(random, 0.05, 0.3), little(0.03), little(0.03));
    if (trial % 2 == 1) std::swap(place.x(), place.y());
    const SE3 first_from_second = {exp_so3({little(0.2), little(0.2), little(0.2)}), place};
    const auto pair = stereo_pair(scenes::rig_of(camera, camera, first_from_second));
    ASSERT_TRUE(pair.has_value()) << pair.error().message;
    ASSERT_EQ(pair->left, 0U);
    const SE3 second_from_first = first_from_second.inverse();
    const cv::Mat k = (cv::Mat_<double>(3, 3) << 600, 0, 319.5, 0, 600, 239.5, 0, 0, 1);
    const cv::Mat t = (cv::Mat_<double>(3, 1) << second_from_first.translation.x(),
                       second_from_first.translation.y(), second_from_first.translation.z());
    cv::Mat r1;
    cv::Mat r2;
    cv::Mat p1;
    cv::Mat p2;
    cv::Mat q;
    cv::stereoRectify(k, cv::noArray(), k, cv::noArray(), {640, 480},
                      to_cv(second_from_first.rotation), t, r1, r2, p1, p2, q);
    EXPECT_LT(cv::norm(r1, to_cv(pair->left_from_rectified.transpose()), cv::NORM_INF), 1e-9);
    EXPECT_LT(cv::norm(r2, to_cv(pair->right_from_rectified.transpose()), cv::NORM_INF), 1e-9);
  }
}

struct RealCamera {
  RigCameraViews seen;
  std::vector<cv::Mat> pictures;  // of the same instants for both
};

RealCamera camera_of(const std::string& name) {
  const real::Set set = {
      name.c_str(), "brown4", "opencv-samples", name.c_str(), "checkerboard:9x6:30mm", true};
  RealCamera camera;
  real::Views read = real::read(set);
  if (read.views.empty()) return camera;
  SolveOptions options;
  options.model = "brown4";
  camera.seen.calibration = solve(read.views, read.size, options).value().calibration;
  camera.seen.calibration.camera = name;
  camera.seen.views = std::move(read.views);
  for (int n = 1; n <= 14; ++n) {
    const std::string number = std::to_string(100 + n).substr(1);
    const auto file = real::folder_of(set) / (name + number + ".jpg");
    if (!std::filesystem::exists(file)) continue;
    camera.pictures.push_back(cv::imread(file.string(), cv::IMREAD_GRAYSCALE));
  }
  return camera;
}

TEST(RealRectification, PutsFoundCornersIntoOneRow) {
  const RealCamera left = camera_of("left");
  const RealCamera right = camera_of("right");
  if (left.seen.views.empty() || right.seen.views.empty()) {
    GTEST_SKIP() << "without CALVIN_DATA there is no opencv-samples";
  }
  const auto solved = solve_rig({left.seen, right.seen});
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  const Undistorter rectified[] = {scenes::rectifier(solved->rig, StereoSide::kLeft).value(),
                                   scenes::rectifier(solved->rig, StereoSide::kRight).value()};
  const auto detector = make_detector(parse_board("checkerboard:9x6:30mm").value()).value();
  double squares = 0;
  int corners = 0;
  for (std::size_t n = 0; n < left.pictures.size(); ++n) {
    std::vector<Observation> found;
    for (std::size_t c = 0; c < 2; ++c) {
      const cv::Mat& picture = (c == 0 ? left : right).pictures[n];
      cv::Mat straight(picture.size(), CV_8U);
      rectified[c].apply(0, {picture.data, static_cast<std::ptrdiff_t>(picture.step[0])},
                         {straight.data, static_cast<std::ptrdiff_t>(straight.step[0])});
      found.push_back(detector
                          ->detect({straight.data, straight.cols, straight.rows,
                                    static_cast<std::ptrdiff_t>(straight.step[0]), 1})
                          .observation);
    }
    // A whole board is named the same in both pictures.
    if (found.size() != 2 || found[0].ids.size() != 54 || found[1].ids.size() != 54) continue;
    for (std::size_t i = 0; i < 54; ++i) {
      ASSERT_EQ(found[0].ids[i], found[1].ids[i]);
      squares += std::pow(found[0].uv[i].v - found[1].uv[i].v, 2);
      ++corners;
    }
  }
  const double rms = std::sqrt(squares / corners);
  std::cout << corners << " corners, rows differ by " << rms << " px rms; link "
            << solved->links[0].epipolar_error.value() << '\n';
  ASSERT_GE(corners, 8 * 54);
  EXPECT_LT(rms, 0.4);
  EXPECT_NEAR(solved->links[0].epipolar_error.value(), rms, 0.15);
}

}  // namespace
}  // namespace calvin
