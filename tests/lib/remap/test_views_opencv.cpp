// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The views of alpha-mode=opencv beside those of OpenCV itself.
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calvin/remap/view.hpp"
#include "remap_reference.hpp"

namespace calvin {
namespace {

// Mild, strong enough that five steps of the inverse leave pixels, and a tilted sensor.
const reference::Lens kOpenCvLenses[] = {
    {"pinhole", "pinhole", {}},
    {"barrel", "brown5", {-0.28, 0.09, 5e-4, -7e-4, 0}},
    {"strong_barrel", "brown4", {-0.4, 0.12, 1e-3, -2e-3}},
    {"pincushion", "brown5", {0.2, -0.1, 1e-3, 5e-4, 0.01}},
    {"rational", "rational8", {0.4, 0.1, 1e-3, -1e-3, 0.01, 0.8, 0.2, 0.02}},
    {"prism", "thinprism12", {-0.2, 0.05, 0, 0, 0, 0, 0, 0, 3e-3, -1e-3, -2e-3, 1e-3}},
    {"tilted", "tilted14", {-0.2, 0.05, 0, 0, 0, 0, 0, 0, 1e-3, 0, 1e-3, 0, 0.05, -0.03}},
    {"folds_back", "brown4", {-0.9, 0.1, 0, 0}}};

class OpenCvView : public ::testing::TestWithParam<reference::Lens> {};
INSTANTIATE_TEST_SUITE_P(OutputView, OpenCvView, ::testing::ValuesIn(kOpenCvLenses),
                         [](const auto& test) { return test.param.name; });

TEST_P(OpenCvView, InTheModeOpenCvIsOpenCvs) {
  const Camera source = reference::camera(GetParam(), {640, 480}, 400, 330, 230);
  const cv::Mat k =
      (cv::Mat_<double>(3, 3) << source.fx(), 0, source.cx(), 0, source.fy(), source.cy(), 0, 0, 1);
  const cv::Mat d = GetParam().k.empty() ? cv::Mat::zeros(1, 4, CV_64F) : cv::Mat(GetParam().k);
  for (const double alpha : {0.0, 0.4, 1.0}) {
    for (const ImageSize size : {ImageSize{640, 480}, ImageSize{321, 200}}) {
      const cv::Mat view =
          cv::getOptimalNewCameraMatrix(k, d, {640, 480}, alpha, {size.width, size.height});
      ViewOptions options;
      options.alpha = alpha;
      options.output = size;
      options.alpha_mode = AlphaMode::kOpenCv;
      const Camera ours = output_camera(source, options).value();
      // OpenCV 4.6 has rectangles of single precision.
      const double rounding = 1e-6 * std::max(ours.fx(), ours.fy());
      EXPECT_NEAR(ours.fx(), view.at<double>(0, 0), rounding) << alpha;
      EXPECT_NEAR(ours.fy(), view.at<double>(1, 1), rounding) << alpha;
      EXPECT_NEAR(ours.cx(), view.at<double>(0, 2), rounding) << alpha;
      EXPECT_NEAR(ours.cy(), view.at<double>(1, 2), rounding) << alpha;
    }
  }
}

}  // namespace
}  // namespace calvin
