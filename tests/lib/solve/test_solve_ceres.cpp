// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The same optimum as Ceres finds with formulas of its own (ceres_formulas.hpp), for every model:
// from our solution pushed off, and from a start that knows nothing of it.
#include <algorithm>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "ceres_solver.hpp"
#include "plain_options.hpp"
#include "scenes.hpp"
#include "strong_lens.hpp"

namespace calvin {
namespace {

using formulas::CeresFit;
using formulas::CeresSolver;
using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

void expect_same(const Calibration& ours, double cost, const CeresFit& theirs, const char* start) {
  EXPECT_NEAR(theirs.cost / cost, 1, 1e-10) << start;
  for (std::size_t k = 0; k + 1 < theirs.camera.size(); ++k) {
    const Parameter& p = ours.parameters[k];
    if (!p.sigma) continue;
    EXPECT_NEAR((p.value - theirs.camera[k]) / *p.sigma, 0, 1e-4)
        << p.name << ", sigma " << *p.sigma << ", " << start;
  }
}

// As far from the calibration as its covariance says that it is from the truth.
std::vector<double> drawn(const Calibration& c, Random& random) {
  std::vector<double> values;
  std::vector<std::size_t> estimated;
  for (const Parameter& p : c.parameters) {
    if (p.sigma) estimated.push_back(values.size());
    values.push_back(p.value);
  }
  const auto n = static_cast<Eigen::Index>(estimated.size());
  const Eigen::Map<const Eigen::MatrixXd> covariance(c.covariance.data(), n, n);
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = sigma.cwiseInverse();
  const Eigen::MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  std::normal_distribution<double> normal;
  const Eigen::VectorXd x =
      Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index) { return normal(random); });
  const Eigen::VectorXd move = sigma.cwiseProduct(correlation.llt().matrixL() * x);
  for (Eigen::Index i = 0; i < n; ++i) values[estimated[static_cast<std::size_t>(i)]] += move[i];
  return values;
}

class Ceres : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Peers, Ceres, ::testing::ValuesIn(model_names()),
                         [](const auto& test) { return std::string(test.param); });

// Less noise than real corners have keeps weak coefficients where the problem has one basin.
constexpr double kSigma = 0.02;

TEST_P(Ceres, HasItsOptimumInTheSamePlace) {
  Random random(31);
  const int trials = scenes::full_count() ? 10 : 1;
  for (int trial = 0; trial < trials; ++trial) {
    const Camera truth = scenes::strong_camera(GetParam(), random);
    const auto poses = scenes::random_poses(truth, kBoard, random, 20);
    const auto views = scenes::observe_all(truth, kBoard, poses, kSigma, random);
    const auto solution = solve(views, kSize, scenes::plain_options(GetParam()));
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    const Calibration& ours = solution->calibration;
    const double cost = *ours.rms * *ours.rms * static_cast<double>(views.size()) * 54;

    std::vector<double> at;
    std::vector<int> fixed;
    for (const Parameter& p : ours.parameters) {
      if (!p.sigma) fixed.push_back(static_cast<int>(at.size()));
      at.push_back(p.value);
    }
    CeresSolver ceres(GetParam(), views, fixed);
    ASSERT_TRUE(ceres.usable()) << "write the formula of " << GetParam() << " for Ceres";
    std::vector<SE3> found;
    for (const ViewRecord& view : ours.views) found.push_back(to_se3(view.camera_from_board));
    ceres.start(at, found);
    EXPECT_NEAR(ceres.cost() / cost, 1, 1e-10) << "the formulas differ";

    const std::vector<double> pushed = drawn(ours, random);
    std::vector<SE3> moved = found;
    for (SE3& pose : moved) {
      pose.rotation = exp_so3({0.0002, -0.0003, 0.0001}) * pose.rotation;
      pose.translation *= 1.0002;
    }
    ceres.start(pushed, moved);
    expect_same(ours, cost, ceres.solve(), "from ours, pushed");

    ceres.start(truth.parameters(), poses);
    expect_same(ours, cost, ceres.solve(), "from the truth");
  }
}

}  // namespace
}  // namespace calvin
