// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// expected_error() against cameras drawn from the covariance, each turned back as well as it goes.
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "calvin/solve/uncertainty.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kSize;
using scenes::Random;

constexpr int kColumns = 40;
constexpr int kRows = 30;

std::vector<Pixel> grid() {
  std::vector<Pixel> pixels;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      pixels.push_back(
          {x * (kSize.width - 1.0) / (kColumns - 1), y * (kSize.height - 1.0) / (kRows - 1)});
    }
  }
  return pixels;
}

// The pixels that a camera, turned by w, sees the rays at, less `pixels`.
Eigen::VectorXd differences(const Camera& camera, const std::vector<Eigen::Vector3d>& rays,
                            const std::vector<Pixel>& pixels, const Eigen::Vector3d& w) {
  const Eigen::Matrix3d r = exp_so3(w);
  Eigen::VectorXd e(2 * static_cast<Eigen::Index>(rays.size()));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto at = camera.project(r * rays[i]);
    const auto k = 2 * static_cast<Eigen::Index>(i);
    e[k] = at ? at->u - pixels[i].u : 0;
    e[k + 1] = at ? at->v - pixels[i].v : 0;
  }
  return e;
}

// (J^T J)^-1 J^T of differences() by w, J by central differences.
Eigen::MatrixXd turning_back(const Camera& camera, const std::vector<Eigen::Vector3d>& rays,
                             const std::vector<Pixel>& pixels) {
  Eigen::MatrixXd j(2 * static_cast<Eigen::Index>(rays.size()), 3);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(k);
    j.col(k) =
        (differences(camera, rays, pixels, h) - differences(camera, rays, pixels, -h)) / 2e-6;
  }
  return (j.transpose() * j).ldlt().solve(j.transpose());
}

class Uncertainty : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Expected, Uncertainty, ::testing::ValuesIn(scenes::kSolvedModels),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(Uncertainty, ExpectedErrorEqualsThatOfSampledCameras) {
  Random random(5);
  const Camera truth = scenes::random_camera(GetParam(), random);
  const auto poses = scenes::random_poses(truth, scenes::kBoard, random, 15);
  const auto views = scenes::observe_all(truth, scenes::kBoard, poses, 0.1, random);
  SolveOptions options;
  options.model = GetParam();
  const Calibration c = solve(views, kSize, options).value().calibration;
  const Camera center = Camera::make(c).value();
  const auto n = static_cast<Eigen::Index>(c.parameters.size());
  const Eigen::MatrixXd covariance = Eigen::Map<const Eigen::MatrixXd>(c.covariance.data(), n, n);
  // A tenth of the noise keeps the samples in the linear range that the figure describes.
  const Eigen::MatrixXd root = 0.1 * Eigen::MatrixXd(covariance.llt().matrixL());

  std::vector<Pixel> pixels;
  std::vector<Eigen::Vector3d> rays;
  for (const Pixel& pixel : grid()) {
    if (const auto ray = center.unproject(pixel)) {
      pixels.push_back(pixel);
      rays.push_back(*ray);
    }
  }
  const Eigen::MatrixXd back = turning_back(center, rays, pixels);
  std::vector<Eigen::Matrix2d> spread(rays.size(), Eigen::Matrix2d::Zero());
  const int samples = scenes::full_count() ? 3000 : 600;
  std::normal_distribution<double> normal;
  for (int s = 0; s < samples; ++s) {
    const Eigen::VectorXd move =
        root * Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index) { return normal(random); });
    std::vector<double> p = center.parameters();
    for (Eigen::Index i = 0; i < n; ++i) p[static_cast<std::size_t>(i)] += move[i];
    const Camera camera = Camera::make(GetParam(), kSize, p).value();
    Eigen::Vector3d w = Eigen::Vector3d::Zero();
    for (int i = 0; i < 2; ++i) w -= back * differences(camera, rays, pixels, w);
    const Eigen::VectorXd e = differences(camera, rays, pixels, w);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector2d d = e.segment<2>(2 * static_cast<Eigen::Index>(i));
      spread[i] += d * d.transpose() / samples;
    }
  }
  double worst = 0;
  for (const Eigen::Matrix2d& m : spread) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(m, Eigen::EigenvaluesOnly);
    worst = std::max(worst, eigen.eigenvalues()[1]);
  }
  ASSERT_TRUE(c.expected_error.has_value());
  EXPECT_NEAR(10 * std::sqrt(worst) / *c.expected_error, 1, scenes::full_count() ? 0.04 : 0.09);
}

TEST(ExpectedError, IsAbsentWithoutAUsableCovariance) {
  Random random(6);
  Calibration c = scenes::random_camera("brown5", random).to_calibration();
  EXPECT_FALSE(expected_error(c).has_value());
  c.parameters[0].sigma = 1;
  EXPECT_FALSE(expected_error(c).has_value());
  c.covariance = {std::numeric_limits<double>::quiet_NaN()};
  EXPECT_FALSE(expected_error(c).has_value());
  c.covariance = {1};
  EXPECT_TRUE(expected_error(c).has_value());
  c.parameters[0].value = -5;
  EXPECT_FALSE(expected_error(c).has_value());
}

TEST(ExpectedError, OfTheFocalLengthAloneIsTheErrorAtTheCorner) {
  // du = (u - cx)/fx sigma; no rotation about the axis or across it explains a change of scale on a
  // grid that is symmetric about the principal point.
  Calibration c =
      Camera::make("pinhole", {641, 481}, {500, 500, 320, 240}).value().to_calibration();
  c.parameters[0].sigma = 2;
  c.parameters[1].sigma = 2;
  c.covariance = {4, 4, 4, 4};
  EXPECT_NEAR(expected_error(c).value(), 2.0 * std::hypot(320, 240) / 500, 1e-9);
}

}  // namespace
}  // namespace calvin
