// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A set that others have rendered ($CALVIN_DATA/dice-checkerboard), of which the cameras are known:
// its corners make these cameras, and no row of them is off the camera that they make.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <opencv2/imgcodecs.hpp>

#include "calvin/camera/camera.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {
namespace {

constexpr Checkerboard kDice = {12, 8, 0.005};
constexpr ImageSize kPicture = {1920, 1200};

struct DiceCamera {
  int number;
  Eigen::Vector4d truth;  // fx fy cx cy; the coefficients that the set tells are not the true ones
};

class Dice : public ::testing::TestWithParam<DiceCamera> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("CALVIN_DATA");
    const auto folder = std::filesystem::path(data == nullptr ? "" : data) / "dice-checkerboard";
    if (data == nullptr || !std::filesystem::is_directory(folder)) {
      GTEST_SKIP() << "CALVIN_DATA names no folder with dice-checkerboard";
    }
    const auto detector = std::move(*make_detector(Board(kDice)));
    for (std::size_t i = 0; i < 21; ++i) {
      const std::string number = std::to_string(100 + i).substr(1);
      const auto file = folder / (number + '_' + std::to_string(GetParam().number) + ".jpeg");
      const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
      ASSERT_FALSE(image.empty()) << file;
      auto seen = detector->detect(
          {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1});
      EXPECT_EQ(seen.observation.ids.size(), 96U) << file;
      seen.observation.timestamp = i;
      views_.push_back({std::move(seen.observation), Board(kDice)});
    }
  }
  std::vector<View> views_;
};
INSTANTIATE_TEST_SUITE_P(Cameras, Dice,
                         ::testing::Values(DiceCamera{0, {6673.3159, 6669.3027, 872.1577, 579.955}},
                                           DiceCamera{1, {6607.61, 6602.85, 917.973, 531.635}}),
                         [](const auto& test) { return std::to_string(test.param.number); });

// e^T C^-1 e / 4 of focal lengths and centre.
double error_of(const Calibration& calibration, const Eigen::Vector4d& truth) {
  Eigen::Vector4d error;
  Eigen::Index n = 0;
  for (const Parameter& p : calibration.parameters) n += p.sigma ? 1 : 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    error[k] = calibration.parameters[i].value - truth[k];
  }
  const Eigen::MatrixXd all =
      Eigen::Map<const Eigen::MatrixXd>(calibration.covariance.data(), n, n);
  const Eigen::Matrix4d covariance = all.topLeftCorner<4, 4>();
  return error.dot(covariance.ldlt().solve(error)) / 4;
}

// The largest mean residual of a row or a column of a view, px along u or v.
double worst_line(const Camera& camera, const ViewRecord& record, const Observation& seen) {
  const auto& r = record.camera_from_board.rotation;
  const auto& t = record.camera_from_board.translation;
  const SE3 pose = {exp_so3({r[0], r[1], r[2]}), {t[0], t[1], t[2]}};
  const auto points = Board(kDice).points();
  std::array<Eigen::Vector2d, 20> lines;  // columns, then rows
  lines.fill(Eigen::Vector2d::Zero());
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const auto id = static_cast<std::size_t>(seen.ids[i]);
    const Pixel at = camera.project(pose * points[id]).value();
    const Eigen::Vector2d off(seen.uv[i].u - at.u, seen.uv[i].v - at.v);
    lines[id % 12] += off / 8;
    lines[12 + id / 12] += off / 12;
  }
  double most = 0;
  for (const auto& line : lines) most = std::max(most, line.cwiseAbs().maxCoeff());
  return most;
}

TEST_P(Dice, MakesTheCamerasThatItWasRenderedWith) {
  const auto solution = solve(views_, kPicture);
  ASSERT_TRUE(solution) << solution.error().message;
  const Calibration& calibration = solution->calibration;
  ASSERT_EQ(calibration.views.size(), views_.size());
  const double error = error_of(calibration, GetParam().truth);
  const Camera camera = Camera::make(calibration).value();
  double worst = 0;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    worst = std::max(worst, worst_line(camera, calibration.views[i], views_[i].observation));
  }
  std::cout << "  e^T C^-1 e / 4 " << error << ", chi " << calibration.chi.value_or(-1)
            << ", a line is off by " << worst << " px at most\n";
  // The mean of four squares is above this in one of twenty cases.
  EXPECT_LT(error, 2.4);
  EXPECT_LT(worst, 0.005);
}

}  // namespace
}  // namespace calvin
