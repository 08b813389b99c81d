// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin/opencv.hpp: cv::projectPoints() and cv::solvePnP() as the judges of what it hands over.
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calvin/geometry/se3.hpp"
#include "calvin/opencv.hpp"

namespace calvin {
namespace {

constexpr ImageSize kSize = {640, 480};

struct Lens {
  const char* model;
  std::vector<double> coefficients;
};
const std::array<Lens, 6> kBrown = {{
    {"pinhole", {}},
    {"brown4", {-0.28, 0.09, 5e-4, -7e-4}},
    {"brown5", {-0.28, 0.09, 5e-4, -7e-4, 0.01}},
    {"rational8", {-0.2, 0.05, 5e-4, -7e-4, 0.01, 0.02, 0.01, 0.001}},
    {"thinprism12", {-0.2, 0.05, 5e-4, -7e-4, 0.01, 0.02, 0.01, 0.001, 2e-3, 1e-3, -1e-3, 5e-4}},
    {"tilted14",
     {-0.2, 0.05, 5e-4, -7e-4, 0.01, 0.02, 0.01, 0.001, 2e-3, 1e-3, -1e-3, 5e-4, 0.02, -0.01}},
}};
const Lens kFisheye = {"fisheye", {-0.02, 0.005, -0.003, 0.0005}};

Camera camera_of(const Lens& lens, double skew = 0) {
  std::vector<double> parameters = {480, 478, 325, 236};
  parameters.insert(parameters.end(), lens.coefficients.begin(), lens.coefficients.end());
  return Camera::make(lens.model, kSize, parameters, skew).value();
}

std::vector<cv::Point3d> points() {
  std::vector<cv::Point3d> all;
  for (int i = 0; i < 40; ++i) {
    all.emplace_back(0.4 * std::sin(1.7 * i), 0.3 * std::cos(2.3 * i), 1 + 0.02 * i);
  }
  return all;
}

void expect_same_pixels(const Camera& ours, const std::vector<cv::Point2d>& theirs) {
  const auto all = points();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto uv = ours.project({all[i].x, all[i].y, all[i].z});
    ASSERT_TRUE(uv.has_value());
    EXPECT_NEAR(uv->u, theirs[i].x, 1e-9) << ours.model();
    EXPECT_NEAR(uv->v, theirs[i].y, 1e-9) << ours.model();
  }
}

TEST(OpenCvConversions, CamerasOfTheBrownFamilyProjectAlikeAndComeBack) {
  for (const Lens& lens : kBrown) {
    const Calibration calibration = camera_of(lens).to_calibration();
    const auto camera = to_opencv(calibration);
    ASSERT_TRUE(camera.has_value()) << camera.error().message;
    std::vector<cv::Point2d> uv;
    cv::projectPoints(points(), cv::Vec3d(), cv::Vec3d(), camera->matrix, camera->distortion, uv);
    expect_same_pixels(camera_of(lens), uv);
    const auto back =
        calibration_from_opencv(cv::Mat(camera->matrix), cv::Mat(camera->distortion), kSize);
    ASSERT_TRUE(back.has_value()) << back.error().message;
    EXPECT_EQ(back->model, lens.model);
    expect_same_pixels(Camera::make(*back).value(), uv);
  }
}

TEST(OpenCvConversions, AFisheyeGoesItsOwnWay) {
  const Calibration calibration = camera_of(kFisheye).to_calibration();
  EXPECT_FALSE(to_opencv(calibration).has_value());
  EXPECT_FALSE(to_opencv_fisheye(camera_of(kBrown[1]).to_calibration()).has_value());
  const auto camera = to_opencv_fisheye(calibration);
  ASSERT_TRUE(camera.has_value()) << camera.error().message;
  std::vector<cv::Point2d> uv;
  cv::fisheye::projectPoints(points(), uv, cv::Vec3d(), cv::Vec3d(), cv::Mat(camera->matrix),
                             cv::Mat(camera->distortion));
  expect_same_pixels(camera_of(kFisheye), uv);
  const auto back =
      calibration_from_opencv_fisheye(cv::Mat(camera->matrix), cv::Mat(camera->distortion), kSize);
  ASSERT_TRUE(back.has_value()) << back.error().message;
  expect_same_pixels(Camera::make(*back).value(), uv);
}

TEST(OpenCvConversions, WhatOpenCvCannotHoldIsRefused) {
  EXPECT_EQ(to_opencv(camera_of(kBrown[1], 0.5).to_calibration()).error().code,
            ErrorCode::kUnsupported);
  EXPECT_EQ(to_opencv(Calibration{}).error().code, Camera::make(Calibration{}).error().code);
  const cv::Mat one = cv::Mat::eye(3, 3, CV_64F);
  const cv::Mat six(1, 6, CV_64F, cv::Scalar(0));
  EXPECT_FALSE(calibration_from_opencv(one, six, kSize).has_value());
  EXPECT_FALSE(calibration_from_opencv(cv::Mat(), cv::Mat(), kSize).has_value());
  EXPECT_FALSE(calibration_from_opencv(cv::Mat::zeros(3, 3, CV_64F), cv::Mat(), kSize).has_value());
  EXPECT_TRUE(calibration_from_opencv(one, cv::Mat(), kSize).has_value());
  EXPECT_EQ(calibration_from_opencv(one, cv::Mat(), {0, 0}).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(image_view(cv::Mat(4, 4, CV_8UC3)).data, nullptr);
}

// Corners of a board that is seen at a known place: cv::solvePnP() of the converted points gives
// it.
TEST(OpenCvConversions, CornersGiveTheirPoseToOpenCv) {
  const Board board = parse_board("checkerboard:9x6:25mm").value();
  const Camera camera = camera_of(kBrown[2]);
  const SE3 truth = {exp_so3({0.3, -0.2, 0.1}), {-0.1, -0.05, 0.6}};
  std::vector<cv::Point2f> corners;
  for (const auto& point : board.points()) {
    const Pixel uv = camera.project(truth * point).value();
    corners.emplace_back(static_cast<float>(uv.u), static_cast<float>(uv.v));
  }
  const auto seen = observation_from_opencv(corners, board, kSize);
  ASSERT_TRUE(seen.has_value());
  EXPECT_FALSE(observation_from_opencv({corners[0]}, board, kSize).has_value());
  Observation some = *seen;
  some.ids.push_back(999);  // that is not on the board
  some.uv.push_back({});
  const OpenCvPoints points = to_opencv(some, board);
  ASSERT_EQ(points.object.size(), corners.size());
  const auto theirs = to_opencv(camera.to_calibration()).value();
  cv::Vec3d rotation;
  cv::Vec3d translation;
  ASSERT_TRUE(cv::solvePnP(points.object, points.image, theirs.matrix, theirs.distortion, rotation,
                           translation));
  EXPECT_NEAR(cv::norm(translation - cv::Vec3d(-0.1, -0.05, 0.6)), 0, 1e-5);
  EXPECT_NEAR(cv::norm(rotation - cv::Vec3d(0.3, -0.2, 0.1)), 0, 1e-4);
}

TEST(OpenCvConversions, APictureIsSeenInPlaceWithItsStride) {
  cv::Mat whole(20, 30, CV_8UC1, cv::Scalar(7));
  const cv::Mat part = whole(cv::Rect(5, 4, 10, 8));
  whole.at<unsigned char>(6, 8) = 200;
  const ImageView view = image_view(part);
  EXPECT_EQ(view.size(), (ImageSize{10, 8}));
  EXPECT_EQ(view.at(3, 2), 200);
  EXPECT_EQ(view.at(4, 2), 7);
}

}  // namespace
}  // namespace calvin
