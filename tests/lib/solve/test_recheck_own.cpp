// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Recheck with the views that a calibration was made of, and with a camera that has changed a
// little.
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/solve/recheck.hpp"
#include "calvin/target/board.hpp"
#include "calvin_config.h"
#include "recheck_truth.hpp"
#if CALVIN_HAVE_OPENCV
#include <opencv2/imgcodecs.hpp>
#endif

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;
using scenes::true_change;
using scenes::views_of;

class EveryModel : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(RecheckOwn, EveryModel, ::testing::ValuesIn(scenes::kSolvedModels),
                         [](const auto& test) { return std::string(test.param); });

// The views of a solve, of a sheet of paper: its corners are .15 mm from where they should be, and
// in each view it is bent by another 1 mm, so that each view by itself asks for another camera.
struct OwnViews {
  std::vector<View> views;
  Camera camera;  // the true one
};
OwnViews of_a_sheet_of_paper(std::string_view model, int seed, int count) {
  Random random(seed);
  const Camera camera = scenes::random_camera(model, random);
  std::normal_distribution<double> normal(0, 1);
  auto points = kBoard.points();
  for (Eigen::Vector3d& p : points) {
    for (int k = 0; k < 2; ++k) p[k] += 0.15e-3 * normal(random);
  }
  OwnViews own = {{}, camera};
  for (const SE3& pose : scenes::random_poses(camera, kBoard, random, count)) {
    own.views.push_back(scenes::observe(camera, kBoard, pose, 0.05, random));
    auto& seen = own.views.back().observation;
    const double bend = 1e-3 * normal(random);
    for (std::size_t i = 0; i < points.size(); ++i) {
      Eigen::Vector3d point = points[i];
      const double x = 2 * point.x() / kBoard.extent().width() - 1;
      point.z() = bend * (1 - x * x);
      const auto at = camera.project(pose * point);
      if (at) seen.uv[i] = {at->u + 0.05 * normal(random), at->v + 0.05 * normal(random)};
    }
  }
  return own;
}

// Of the views that a calibration was made of, none may tell of a change: not the first one, and
// not all of them together.
TEST_P(EveryModel, HasNotMovedForItsOwnViews) {
  int messages = 0;
  int alarms = 0;
  for (int session = 0; session < 10; ++session) {
    const auto own = of_a_sheet_of_paper(GetParam(), session, 15);
    SolveOptions options;
    options.model = GetParam();
    const auto solution = solve(own.views, kSize, options);
    ASSERT_TRUE(solution) << solution.error().message;
    Recheck recheck(Camera::make(solution->calibration).value(), solution->calibration);
    RecheckReport report;
    for (const View& view : own.views) {
      report = recheck.add(view).value();
      EXPECT_GT(report.displacement_sigma, 0);
      alarms += report.displacement > 2 * report.displacement_sigma;
      ++messages;
    }
    EXPECT_EQ(report.displacement, 0) << session;
  }
  EXPECT_EQ(alarms, 0) << "of " << messages;
}

// Half a percent of the focal length, after ten views; by as much as it is, give or take what it
// says itself.
TEST_P(EveryModel, ASmallChangeOfFocalLengthIsNoticed) {
  constexpr int kSessions = 20;
  int noticed = 0;
  int right = 0;
  for (int session = 0; session < kSessions; ++session) {
    Random random(session);
    const Camera camera = scenes::random_camera(GetParam(), random);
    SolveOptions options;
    options.model = GetParam();
    const auto solution = solve(views_of(camera, random, 25, 0.1), kSize, options);
    ASSERT_TRUE(solution) << solution.error().message;
    std::vector<double> p = camera.parameters();
    p[0] *= 1.005;
    p[1] *= 1.005;
    const Camera now = Camera::make(GetParam(), kSize, p).value();
    const auto views = views_of(now, random, 10, 0.1);
    Recheck recheck(Camera::make(solution->calibration).value(), solution->calibration);
    RecheckReport report;
    for (const View& view : views) report = recheck.add(view).value();
    noticed += report.displacement > 2 * report.displacement_sigma;
    const double truth = true_change(camera, now, views);
    right += std::abs(report.displacement - truth) < 3 * report.displacement_sigma;
  }
  EXPECT_GE(noticed, kSessions - 2);
  EXPECT_GE(right, kSessions - 2);
}

TEST(RecheckOwn, WhatIsSaidHasFigureAndSigma) {
  RecheckReport report;
  report.displacement_sigma = 0.2;
  EXPECT_EQ(advice(report), "");
  report.displacement = 1.3;
  EXPECT_EQ(advice(report),
            "The lens has moved: the picture is off by 1.3 +- 0.2 px where the board was seen. "
            "Calibrate the camera again.");
}

#if CALVIN_HAVE_OPENCV
// The boards in the pictures of one of the cameras of opencv-samples.
std::vector<View> views_in(const std::filesystem::path& folder, const std::string& camera) {
  const Board board = parse_board("checkerboard:9x6:30mm").value();
  const auto finder = make_detector(board);
  std::vector<View> views;
  for (int i = 1; finder && i <= 14; ++i) {
    const auto file = folder / fmt::format("{}{:02}.jpg", camera, i);
    if (!std::filesystem::exists(file)) continue;  // there is no left10.jpg
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    auto seen = (*finder)->detect(
        {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1});
    if (seen.observation.found()) views.push_back({std::move(seen.observation), board});
  }
  return views;
}

// Real pictures, whose board is not as printed: those that a calibration was made of tell of no
// change, and ten of them notice a focal length that is 2 % longer.
TEST(RecheckOwn, OfRealPictures) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder = std::filesystem::path(data == nullptr ? "" : data) / "opencv-samples";
  if (data == nullptr || !std::filesystem::exists(folder)) {
    GTEST_SKIP() << "CALVIN_DATA names no folder with opencv-samples/left*.jpg";
  }
  int messages = 0;
  int alarms = 0;
  for (const char* name : {"left", "right"}) {
    const auto views = views_in(folder, name);
    ASSERT_GE(views.size(), 12U);
    const Calibration calibration = solve(views, {640, 480}, {}).value().calibration;
    Calibration longer = calibration;
    for (Parameter& p : longer.parameters) p.value *= p.name == "fx" || p.name == "fy" ? 1.02 : 1;
    Recheck same(Camera::make(calibration).value(), calibration);
    Recheck other(Camera::make(longer).value(), longer);
    RecheckReport last;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const auto report = same.add(views[i]).value();
      alarms += report.displacement > 2 * report.displacement_sigma;
      ++messages;
      if (i < 10) last = other.add(views[i]).value();
    }
    EXPECT_GT(last.displacement, 2 * last.displacement_sigma) << name;
  }
  EXPECT_LE(alarms, messages / 10);
}
#endif

}  // namespace
}  // namespace calvin
