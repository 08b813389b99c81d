// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a solve promises of its parameters and of every pixel, against many solves; expected_error()
// against cameras drawn from the covariance, each turned back as well as it goes.
#include <algorithm>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "calvin/core/text.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/solve/difference.hpp"
#include "calvin/solve/judge/projection_grid.hpp"
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

// The derivatives of differences() by w, central differences.
Eigen::MatrixXd turning(const Camera& camera, const std::vector<Eigen::Vector3d>& rays,
                        const std::vector<Pixel>& pixels) {
  Eigen::MatrixXd j(2 * static_cast<Eigen::Index>(rays.size()), 3);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(k);
    j.col(k) =
        (differences(camera, rays, pixels, h) - differences(camera, rays, pixels, -h)) / 2e-6;
  }
  return j;
}

// (J^T J)^-1 J^T of these.
Eigen::MatrixXd turning_back(const Camera& camera, const std::vector<Eigen::Vector3d>& rays,
                             const std::vector<Pixel>& pixels) {
  const Eigen::MatrixXd j = turning(camera, rays, pixels);
  return (j.transpose() * j).ldlt().solve(j.transpose());
}

// Where a picture ends inside the image or near its border, which pixels count is a matter of luck;
// and so it is where the image reaches far beyond what any board shows, which no lens has.
Camera camera_of_a_whole_picture(std::string_view model, Random& random) {
  for (;;) {
    Camera camera = scenes::random_camera(model, random);
    const std::vector<Pixel> pixels = grid();
    const auto beyond = [&camera](const Pixel& p) {
      constexpr double kMargin = 1.1;
      constexpr double kFarthest = 1.9;  // rad, from the axis
      const auto ray = camera.unproject({camera.cx() + kMargin * (p.u - camera.cx()),
                                         camera.cy() + kMargin * (p.v - camera.cy())});
      return ray && ray->z() > std::cos(kFarthest);
    };
    if (std::all_of(pixels.begin(), pixels.end(), beyond)) {
      return camera;
    }
  }
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
  ASSERT_TRUE(c.expected_error_anywhere.has_value());
  EXPECT_NEAR(10 * std::sqrt(worst) / *c.expected_error_anywhere, 1,
              scenes::full_count() ? 0.04 : 0.09);
}

struct Trials {
  const char* model;
  int views;

  friend std::ostream& operator<<(std::ostream& out, const Trials& t) {
    return out << t.model << t.views;
  }
};

// What many solves of the same views, each with noise of its own, find and promise.
class MonteCarlo : public ::testing::TestWithParam<Trials> {
 protected:
  // Of the parameters.
  Eigen::VectorXd squares_;     // mean square of the error
  Eigen::VectorXd sigmas_;      // mean of what is promised
  Eigen::VectorXd inside_;      // part of the errors within 1.96 sigma
  Eigen::MatrixXd covariance_;  // mean of what is promised
  // Of the pixels of the grid: mean square of how far they move, u and v, and their matrix.
  std::vector<Eigen::Matrix2d> spread_;

  std::vector<Pixel> pixels_;
  std::vector<Eigen::Vector3d> rays_;
  Eigen::MatrixXd back_;

  void run(const Camera& truth, int count) {
    Random random(17);
    const auto poses = telling_poses(truth, random);
    look_at(truth);
    const auto n = static_cast<Eigen::Index>(truth.parameters().size());
    squares_ = sigmas_ = inside_ = Eigen::VectorXd::Zero(n);
    covariance_ = Eigen::MatrixXd::Zero(n, n);
    spread_.assign(rays_.size(), Eigen::Matrix2d::Zero());
    for (int i = 0; i < count; ++i) {
      const auto views = scenes::observe_all(truth, scenes::kBoard, poses, 0.1, random);
      const auto solution = solve(views, kSize, options());
      ASSERT_TRUE(solution.has_value()) << i << ": " << solution.error().message;
      add(truth, solution->calibration, 1.0 / count);
    }
  }

  [[nodiscard]] static SolveOptions options() {
    SolveOptions options;
    options.model = GetParam().model;
    options.warp = false;
    options.checks = false;
    return options;
  }

  // The truth with the covariance that is promised on average.
  [[nodiscard]] Calibration promised(const Camera& truth) const {
    Calibration c = truth.to_calibration();
    for (Eigen::Index i = 0; i < covariance_.rows(); ++i) {
      c.parameters[static_cast<std::size_t>(i)].sigma = std::sqrt(covariance_(i, i));
      for (Eigen::Index k = 0; k < covariance_.cols(); ++k) {
        c.covariance.push_back(covariance_(i, k));
      }
    }
    return c;
  }

  // The derivatives of what add() sees of pixel i by the parameters, the rotation taken out.
  [[nodiscard]] Eigen::MatrixXd sensitivity(const Camera& truth) const {
    const auto n = static_cast<Eigen::Index>(truth.parameters().size());
    Eigen::MatrixXd j(2 * static_cast<Eigen::Index>(rays_.size()), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto moved = [&](double step) {
        std::vector<double> p = truth.parameters();
        p[static_cast<std::size_t>(k)] += step;
        return differences(Camera::make(truth.model(), kSize, p).value(), rays_, pixels_,
                           Eigen::Vector3d::Zero());
      };
      const double h = k < 4 ? 1e-3 : 1e-6;
      j.col(k) = (moved(h) - moved(-h)) / (2 * h);
    }
    return j - turning(truth, rays_, pixels_) * (back_ * j);
  }

 private:
  // Views that tell something of every pixel: where none has a corner near, a lens may fold back
  // within its sigma, and then there is no distance to compare.
  [[nodiscard]] static std::vector<SE3> telling_poses(const Camera& truth, Random& random) {
    constexpr double kTold = 3;  // px
    for (;;) {
      auto poses = scenes::random_poses(truth, scenes::kBoard, random, GetParam().views);
      Random other = random;
      const auto views = scenes::observe_all(truth, scenes::kBoard, poses, 0.1, other);
      const auto solution = solve(views, kSize, options());
      if (!solution) continue;
      const auto expected = expected_error_anywhere(solution->calibration);
      if (expected && *expected < kTold) return poses;
    }
  }

  void look_at(const Camera& truth) {
    for (const Pixel& pixel : grid()) {
      if (const auto ray = truth.unproject(pixel)) {
        pixels_.push_back(pixel);
        rays_.push_back(*ray);
      }
    }
    back_ = turning_back(truth, rays_, pixels_);
  }

  void add(const Camera& truth, const Calibration& c, double weight) {
    const auto n = static_cast<Eigen::Index>(truth.parameters().size());
    for (Eigen::Index i = 0; i < n; ++i) {
      const Parameter& p = c.parameters[static_cast<std::size_t>(i)];
      const double error = p.value - truth.parameters()[static_cast<std::size_t>(i)];
      squares_[i] += weight * error * error;
      sigmas_[i] += weight * p.sigma.value();
      inside_[i] += std::abs(error) < 1.96 * *p.sigma ? weight : 0;
    }
    covariance_ += weight * Eigen::Map<const Eigen::MatrixXd>(c.covariance.data(), n, n);
    const Camera camera = Camera::make(c).value();
    Eigen::Vector3d w = Eigen::Vector3d::Zero();
    for (int i = 0; i < 2; ++i) w -= back_ * differences(camera, rays_, pixels_, w);
    const Eigen::VectorXd e = differences(camera, rays_, pixels_, w);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const Eigen::Vector2d d = e.segment<2>(2 * static_cast<Eigen::Index>(i));
      spread_[i] += weight * d * d.transpose();
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Covariance, MonteCarlo,
                         ::testing::Values(Trials{"brown5", 5}, Trials{"brown5", 10},
                                           Trials{"brown5", 25}, Trials{"fisheye", 5},
                                           Trials{"fisheye", 10}, Trials{"fisheye", 25}),
                         [](const auto& test) {
                           return std::string(test.param.model) + std::to_string(test.param.views);
                         });

TEST_P(MonteCarlo, PredictsTheSpreadOfParametersAndOfEveryPixel) {
  const int count = scenes::full_count() ? 20000 : 250;
  // What the count leaves open comes on top where it is a small one.
  const bool full = scenes::full_count();
  const double ratio = 0.03 + (full ? 0 : 4.5 / std::sqrt(2.0 * count));
  const double part = 0.01 + (full ? 0 : 4.5 * std::sqrt(0.05 * 0.95 / count));
  Random random(23);
  const Camera truth = camera_of_a_whole_picture(GetParam().model, random);
  run(truth, count);
  if (HasFatalFailure()) return;
  for (Eigen::Index i = 0; i < sigmas_.size(); ++i) {
    const auto name = parameter_names(GetParam().model)[static_cast<std::size_t>(i)];
    EXPECT_NEAR(sigmas_[i] / std::sqrt(squares_[i]), 1, ratio) << name;
    EXPECT_NEAR(inside_[i], 0.95, part) << name;
  }
  const Eigen::MatrixXd j = sensitivity(truth);
  double worst = 0;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Eigen::MatrixXd rows = j.middleRows<2>(2 * static_cast<Eigen::Index>(i));
    const Eigen::Matrix2d predicted = rows * covariance_ * rows.transpose();
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(std::sqrt(predicted(k, k) / spread_[i](k, k)), 1, ratio)
          << pixels_[i].u << ", " << pixels_[i].v;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(spread_[i], Eigen::EigenvaluesOnly);
    worst = std::max(worst, eigen.eigenvalues()[1]);
  }
  EXPECT_NEAR(expected_error(promised(truth)).value() / std::sqrt(worst), 1, ratio);
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

// The formula of each place by itself, in the order of the book.
TEST(ExpectedError, IsTheFormulaOfEveryPlace) {
  Random random(29);
  for (const char* model : {"pinhole", "brown5", "fisheye"}) {
    const Camera camera = scenes::random_camera(model, random);
    const auto views =
        scenes::observe_all(camera, scenes::kBoard,
                            scenes::random_poses(camera, scenes::kBoard, random, 25), 0.1, random);
    SolveOptions options;
    options.model = model;
    const auto solution = solve(views, kSize, options);
    ASSERT_TRUE(solution) << solution.error().message;
    const Calibration& c = solution->calibration;
    const auto n = static_cast<Eigen::Index>(c.parameters.size());
    const Eigen::MatrixXd covariance = Eigen::Map<const Eigen::MatrixXd>(c.covariance.data(), n, n);
    double worst = 0;
    for (const auto& cell :
         projection_grid(Camera::make(c).value(), estimated_columns(c).value())) {
      const Eigen::Matrix2d of_place = cell * covariance * cell.transpose();
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(of_place);
      worst = std::max(worst, eigen.eigenvalues()[1]);
    }
    EXPECT_NEAR(*c.expected_error_anywhere / std::sqrt(worst), 1, 1e-9) << model;
  }
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
  // Where corners covered a part that is symmetric too, it is that at the corner of the part.
  c.covered = {{220, 190}, {420, 190}, {420, 290}, {220, 290}};
  EXPECT_NEAR(expected_error(c).value(), 2.0 * std::hypot(100, 50) / 500, 1e-9);
  EXPECT_NEAR(expected_error_anywhere(c).value(), 2.0 * std::hypot(320, 240) / 500, 1e-9);
}

// A board that stays in the upper left: what is promised there is kept there, what is said of the
// picture is larger by far, and a remark tells where the board has not been.
TEST(ExpectedError, IsThatOfWhereTheBoardWas) {
  Random random(31);
  const Camera truth =
      Camera::make("brown5", kSize, {1000, 1000, 640, 480, -0.2, 0.05, 0, 0, 0}).value();
  std::vector<SE3> poses;
  while (poses.size() < 15) {
    const SE3 pose =
        scenes::random_pose(truth, scenes::kBoard, random, scenes::uniform(random, 0.1, 0.7));
    const auto in_corner = [&](const Eigen::Vector3d& point) {
      const auto at = truth.project(pose * point);
      return at && at->u < 0.6 * kSize.width && at->v < 0.6 * kSize.height;
    };
    const auto points = scenes::kBoard.points();
    if (std::all_of(points.begin(), points.end(), in_corner)) poses.push_back(pose);
  }
  int kept = 0;
  constexpr int kTrials = 40;
  for (int i = 0; i < kTrials; ++i) {
    const auto views = scenes::observe_all(truth, scenes::kBoard, poses, 0.1, random);
    SolveOptions options;
    options.warp = false;
    const auto solution = solve(views, kSize, options);
    ASSERT_TRUE(solution) << solution.error().message;
    const Calibration& c = solution->calibration;
    ASSERT_TRUE(c.expected_error && c.expected_error_anywhere && c.worst_place);
    EXPECT_GT(*c.expected_error_anywhere, 3 * *c.expected_error);
    EXPECT_FALSE(contains(c.covered, *c.worst_place));
    const std::string all = join(c.remarks, " ");
    EXPECT_NE(all.find("No corner was seen in the lower right"), std::string::npos) << all;
    DifferenceOptions where;
    where.focus = {c.covered};
    const auto apart = difference(Camera::make(c).value(), truth, where);
    kept += apart && apart->focus.max < 2 * *c.expected_error ? 1 : 0;
  }
  EXPECT_GE(kept, 0.85 * kTrials);
}

}  // namespace
}  // namespace calvin
