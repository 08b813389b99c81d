// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// OpenCV's own reader and writer as the judge of its file formats.
#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin_config.h"
#include "io_samples.hpp"

#if CALVIN_HAVE_OPENCV

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace calvin {
namespace {

constexpr struct {
  const char* format;
  const char* extension;
} kOpenCvFormats[] = {{"opencv-yaml", ".yml"}, {"opencv-xml", ".xml"}, {"opencv-json", ".json"}};

void expect_projects_like(const Camera& camera, const cv::Mat& k, const cv::Mat& d) {
  std::vector<cv::Point3d> points;
  for (const auto& p : test::grid()) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<cv::Point2d> uv;
  const cv::Vec3d zero(0, 0, 0);
  if (camera.model() == "fisheye") {
    cv::fisheye::projectPoints(points, uv, zero, zero, k, d);
  } else {
    cv::projectPoints(points, zero, zero, k, d, uv);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto ours = camera.project({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(ours);
    EXPECT_NEAR(ours->u, uv[i].x, 1e-6);
    EXPECT_NEAR(ours->v, uv[i].y, 1e-6);
  }
}

TEST(OpenCvFile, OpenCvReadsOurs) {
  for (const auto& [format, extension] : kOpenCvFormats) {
    for (const std::string_view model : model_names()) {
      SCOPED_TRACE(std::string(format) + " " + std::string(model));
      if (!test::holds(format, model)) continue;
      Calibration calibration = test::sample(std::string(model));
      calibration.rms = 1;
      calibration.parameters[0].sigma = 0.25;
      const auto text = print_calibration(calibration, format);
      ASSERT_TRUE(text);
      const cv::FileStorage file(*text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
      cv::Mat k;
      cv::Mat d;
      cv::Mat sigma;
      file["camera_matrix"] >> k;
      file["distortion_coefficients"] >> d;
      file["cameraMatrix_std_dev"] >> sigma;
      EXPECT_EQ(static_cast<int>(file["image_width"]), 640);
      EXPECT_EQ(static_cast<double>(file["avg_reprojection_error"]), 1) << *text;
      ASSERT_EQ(sigma.total(), 4U);
      EXPECT_EQ(sigma.at<double>(0), 0.25);
      expect_projects_like(*Camera::make(calibration), k, d);
    }
  }
}

std::string written_by_opencv(const char* extension, const cv::Mat& k, const cv::Mat& d,
                              bool fisheye) {
  cv::FileStorage file(extension, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  file << "calibration_time"
       << "Sat Nov 21 05:10:00 2026";
  file << "image_width" << 640 << "image_height" << 480;
  file << "board_size" << cv::Size(9, 6) << "aspectRatio" << 1.0;
  file << "fisheye_model" << static_cast<int>(fisheye);
  file << "camera_matrix" << k << "distortion_coefficients" << d;
  file << "avg_reprojection_error" << 0.1925;
  file << "per_view_reprojection_errors" << cv::Mat(13, 1, CV_32F, cv::Scalar(0.2));
  file << "images"
       << "["
       << "a b.png"
       << "c.png"
       << "]";
  file << "nested"
       << "{"
       << "inner"
       << "["
       << "{"
       << "x" << 1 << "}"
       << "]"
       << "}";
  return file.releaseAndGetString();
}

TEST(OpenCvFile, WeReadOpenCvs) {
  if (!CALVIN_HAVE_FORMATS) GTEST_SKIP() << "built without formats";
  const cv::Mat k = (cv::Mat_<double>(3, 3) << 520.125, 0, 325, 0, 518, 236.75, 0, 0, 1);
  const cv::Mat lens = (cv::Mat_<double>(1, 5) << -0.28, 0.09, 5e-4, -7e-4, 1e-3);
  for (const auto& [format, extension] : kOpenCvFormats) {
    for (const int type : {CV_64F, CV_32F}) {
      for (const int count : {4, 5, 8, 12, 14}) {
        SCOPED_TRACE(std::string(extension) + " " + std::to_string(count));
        cv::Mat d = cv::Mat::zeros(1, count, CV_64F);
        lens.colRange(0, std::min(count, 5)).copyTo(d.colRange(0, std::min(count, 5)));
        cv::Mat k_typed;
        cv::Mat d_typed;
        k.convertTo(k_typed, type);
        d.convertTo(d_typed, type);
        const auto text = written_by_opencv(extension, k_typed, d_typed.t(), false);
        const auto ours = parse_calibration(text);
        ASSERT_TRUE(ours) << ours.error().message << "\n" << text;
        EXPECT_EQ(ours->model, count == 4 ? "brown4" : "brown5");
        EXPECT_EQ(ours->image_size, (ImageSize{640, 480}));
        EXPECT_EQ(ours->rms, 0.1925);
        k_typed.convertTo(k_typed, CV_64F);
        d_typed.convertTo(d_typed, CV_64F);
        // OpenCV prints a float with 8 digits.
        expect_projects_like(*Camera::make(*ours), k, d);
      }
    }
  }
}

TEST(OpenCvFile, WeReadOpenCvsFisheye) {
  const cv::Mat k = (cv::Mat_<double>(3, 3) << 260, 0, 325, 0, 261, 236, 0, 0, 1);
  const cv::Mat d = (cv::Mat_<double>(4, 1) << -0.02, 0.005, -0.003, 0.0005);
  for (const auto& [format, extension] : kOpenCvFormats) {
    if (!test::readable(format)) continue;
    const auto ours = parse_calibration(written_by_opencv(extension, k, d, true));
    ASSERT_TRUE(ours) << ours.error().message;
    EXPECT_EQ(ours->model, "fisheye");
    expect_projects_like(*Camera::make(*ours), k, d);
  }
}

TEST(OpenCvFile, WithoutDistortion) {
  const cv::Mat k = (cv::Mat_<double>(3, 3) << 260, 0, 325, 0, 261, 236, 0, 0, 1);
  for (const auto& [format, extension] : kOpenCvFormats) {
    if (!test::readable(format)) continue;
    for (const bool fisheye : {false, true}) {
      const auto text = written_by_opencv(extension, k, cv::Mat(), fisheye);
      const auto ours = parse_calibration(text);
      ASSERT_TRUE(ours) << ours.error().message << "\n" << text;
      EXPECT_EQ(ours->model, fisheye ? "fisheye" : "pinhole");
      expect_projects_like(*Camera::make(*ours), k, cv::Mat::zeros(4, 1, CV_64F));
    }
  }
}

}  // namespace
}  // namespace calvin

#endif
