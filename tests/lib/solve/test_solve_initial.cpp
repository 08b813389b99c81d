// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A solve that starts from a calibration, holds parameters at its values, or ties them.
#include <gtest/gtest.h>

#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

std::vector<View> views_of(const Camera& camera, Random& random, int count, double sigma = 0.1) {
  return scenes::observe_all(camera, kBoard, scenes::random_poses(camera, kBoard, random, count),
                             sigma, random);
}

SolveOptions from(const Camera& camera, std::vector<std::string> fix = {}) {
  SolveOptions options;
  options.model = camera.model();
  options.initial = camera.to_calibration();
  options.fix = std::move(fix);
  return options;
}

class EveryModel : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Initial, EveryModel, ::testing::ValuesIn(scenes::kSolvedModels),
                         [](const auto& test) { return std::string(test.param); });

// Where one starts does not matter for where the minimum is: from the truth, and from a camera
// whose numbers are all off.
TEST_P(EveryModel, TheOptimumIsTheSameFromAnyStart) {
  for (int seed = 0; seed < 10; ++seed) {
    Random random(seed);
    const Camera camera = scenes::random_camera(GetParam(), random);
    const auto views = views_of(camera, random, 12);
    SolveOptions alone;
    alone.model = GetParam();
    const auto without = solve(views, kSize, alone);
    ASSERT_TRUE(without) << without.error().message;
    std::vector<double> off = camera.parameters();
    off[0] *= 1.05;
    off[1] *= 1.03;
    off[2] += 20;
    for (const Camera& start : {camera, Camera::make(GetParam(), kSize, off).value()}) {
      const auto with = solve(views, kSize, from(start));
      ASSERT_TRUE(with) << with.error().message;
      for (std::size_t i = 0; i < off.size(); ++i) {
        const Parameter& p = without->calibration.parameters[i];
        EXPECT_NEAR(with->calibration.parameters[i].value, p.value, 1e-3 * *p.sigma) << p.name;
      }
    }
  }
}

// A wrong initial calibration is no worse than none.
TEST_P(EveryModel, AWrongStartIsNotTrusted) {
  Random random(5);
  const Camera camera = scenes::random_camera(GetParam(), random);
  const auto views = views_of(camera, random, 12);
  std::vector<double> wrong = camera.parameters();
  wrong[0] *= 5;
  wrong[1] *= 5;
  const auto solution = solve(views, kSize, from(Camera::make(GetParam(), kSize, wrong).value()));
  ASSERT_TRUE(solution) << solution.error().message;
  EXPECT_LT(scenes::normalised_error(solution->calibration, camera), 4);
}

TEST(Initial, WhatIsFixedKeepsItsValue) {
  Random random(1);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto views = views_of(camera, random, 10);
  const auto solution = solve(views, kSize, from(camera, {"fx", "cx", "k1", "k3"}));
  ASSERT_TRUE(solution) << solution.error().message;
  const Calibration& c = solution->calibration;
  for (const char* name : {"fx", "cx", "k1", "k3"}) {
    EXPECT_EQ(c.find(name)->value, camera.to_calibration().find(name)->value) << name;
    EXPECT_FALSE(c.find(name)->sigma) << name;
  }
  // Nine parameters less four.
  EXPECT_EQ(c.covariance.size(), 25u);
  EXPECT_LT(scenes::normalised_error(c, camera), 4);
}

// Two tilts leave nothing open of a pinhole that is held.
TEST(Initial, TheDistortionAloneIsFoundFromTwoTilts) {
  Random random(2);
  const Camera camera = scenes::random_camera("brown4", random);
  auto views = views_of(camera, random, 2);
  views.push_back(views.front());
  const auto solution = solve(views, kSize, from(camera, {"fx", "fy", "cx", "cy"}));
  ASSERT_TRUE(solution) << solution.error().message;
  EXPECT_EQ(solution->calibration.covariance.size(), 16u);
}

TEST(Initial, AspectIsThatOfTheInitialCamera) {
  Random random(2);
  const Camera camera =
      Camera::make("brown4", kSize, {1200, 1100, 630, 470, -0.2, 0.05, 0, 0}).value();
  const auto solution = solve(views_of(camera, random, 10), kSize, from(camera, {"aspect"}));
  ASSERT_TRUE(solution) << solution.error().message;
  const Calibration& c = solution->calibration;
  EXPECT_NEAR(c.find("fy")->value / c.find("fx")->value, 1100.0 / 1200, 1e-12);
  EXPECT_NEAR(*c.find("fy")->sigma / *c.find("fx")->sigma, 1100.0 / 1200, 1e-9);
  EXPECT_NEAR(c.find("fx")->value, 1200, 5 * *c.find("fx")->sigma);
}

TEST(Initial, TiedParametersAreOne) {
  Random random(3);
  const Camera camera =
      Camera::make("brown4", kSize, {1200, 1200, 630, 470, 0.05, 0.05, 0, 0}).value();
  SolveOptions options;
  options.model = "brown4";
  options.fix = {"fx=fy", " k1 = k2"};
  const auto solution = solve(views_of(camera, random, 10), kSize, options);
  ASSERT_TRUE(solution) << solution.error().message;
  const Calibration& c = solution->calibration;
  EXPECT_EQ(c.find("fx")->value, c.find("fy")->value);
  EXPECT_EQ(c.find("k1")->value, c.find("k2")->value);
  EXPECT_EQ(*c.find("k1")->sigma, *c.find("k2")->sigma);
  EXPECT_NEAR(c.find("k1")->value, 0.05, 5 * *c.find("k1")->sigma);
}

// The lens is then a pinhole, and not what a solve of its model starts from.
TEST(Initial, ACoefficientThatIsFixedAtNothingBendsNothing) {
  Random random(6);
  const Camera camera = Camera::make("pinhole", kSize, {1200, 1190, 630, 470}).value();
  const auto views = views_of(camera, random, 10);
  for (const std::string_view model : {"fov", "ucm", "eucm", "doublesphere"}) {
    const LensTraits& lens = *find_lens(model);
    SolveOptions options;
    options.model = model;
    options.fix = {lens.coefficients.begin(), lens.coefficients.end()};
    for (const bool from_another_model : {false, true}) {
      if (from_another_model) options.initial = camera.to_calibration();
      const auto solution = solve(views, kSize, options);
      ASSERT_TRUE(solution) << model << ": " << solution.error().message;
      const Calibration& c = solution->calibration;
      for (const std::string_view name : lens.coefficients) {
        EXPECT_EQ(c.find(name)->value, name == "beta" ? 1 : 0) << model << " " << name;
      }
      EXPECT_NEAR(c.find("fx")->value, 1200, 5 * *c.find("fx")->sigma) << model;
    }
  }
}

// Coefficients of one kind of lens say nothing of another kind; those of a smaller model do.
TEST(Initial, AnotherModelGivesWhatItHas) {
  Random random(4);
  const Camera small =
      Camera::make("brown4", kSize, {1200, 1190, 630, 470, -0.2, 0.05, 0, 0}).value();
  SolveOptions options = from(small, {"k1"});
  options.model = "brown5";
  const auto views = views_of(small, random, 10);
  EXPECT_EQ(solve(views, kSize, options)->calibration.find("k1")->value, -0.2);
  const Camera wide = Camera::make("fisheye", kSize, {420, 420, 630, 470, 0.01, 0, 0, 0}).value();
  options.initial = wide.to_calibration();
  EXPECT_EQ(solve(views, kSize, options)->calibration.find("k1")->value, 0);
}

TEST(Initial, IsAMeasurementWhereItIsAPrior) {
  Random random(14);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto views = views_of(camera, random, 10);
  const Calibration alone = solve(views, kSize).value().calibration;
  SolveOptions options;
  options.initial_is_prior = true;
  const auto with_sigmas = [&](double factor) {
    options.initial = camera.to_calibration();
    for (std::size_t i = 0; i < alone.parameters.size(); ++i) {
      options.initial->parameters[i].sigma = factor * *alone.parameters[i].sigma;
    }
    return solve(views, kSize, options).value().calibration;
  };
  const Calibration sure = with_sigmas(1e-4);
  const Calibration unsure = with_sigmas(1e4);
  const Calibration equal = with_sigmas(1);
  for (std::size_t i = 0; i < alone.parameters.size(); ++i) {
    const double sigma = *alone.parameters[i].sigma;
    const double truth = camera.parameters()[i];
    const auto off = [&](const Calibration& c, double from) {
      return std::abs(c.parameters[i].value - from) / sigma;
    };
    EXPECT_LT(off(sure, truth), 1e-3) << alone.parameters[i].name;
    EXPECT_LT(off(unsure, alone.parameters[i].value), 1e-3) << alone.parameters[i].name;
    EXPECT_LT(*equal.parameters[i].sigma, 0.72 * sigma) << alone.parameters[i].name;
  }
  // A start is no measurement.
  options.initial_is_prior = false;
  EXPECT_NEAR(with_sigmas(1e-4).find("fx")->value, alone.find("fx")->value, 1e-4);
}

// Nine measurements more are nine degrees of freedom more: with few corners they decide what chi
// and the sigmas are.
TEST(Initial, AsAPriorLeavesChiAndCovarianceHonest) {
  const Board small = Checkerboard{4, 3, 0.05};
  constexpr double kSigmas[] = {3, 3, 3, 3, 3e-3, 3e-3, 3e-4, 3e-4, 3e-3};
  constexpr int kSessions = 200;
  // What the fit leaves over: 48 residuals and 9 priors less 12 + 9 unknowns.
  constexpr double kDegrees = 36;
  Random random(17);
  std::normal_distribution<double> noise(0, 1);
  SolveOptions options;
  options.reject_outliers = false;
  options.initial_is_prior = true;
  double chi = 0;
  double error = 0;
  for (int i = 0; i < kSessions; ++i) {
    const Camera camera = scenes::random_camera("brown5", random);
    options.initial = camera.to_calibration();
    for (std::size_t k = 0; k < std::size(kSigmas); ++k) {
      options.initial->parameters[k].value += kSigmas[k] * noise(random);
      options.initial->parameters[k].sigma = kSigmas[k];
    }
    auto views = scenes::observe_all(camera, small, scenes::random_poses(camera, small, random, 2),
                                     1, random);
    const auto told = solve(views, kSize, options);
    ASSERT_TRUE(told) << told.error().message;
    chi += std::pow(*told->calibration.chi, 2) / kSessions;
    // Where the corners come without, their sigma is what is left over.
    for (View& view : views) view.observation.sigma.clear();
    const auto measured = solve(views, kSize, options);
    ASSERT_TRUE(measured) << measured.error().message;
    error += scenes::normalised_error(measured->calibration, camera) / kSessions;
  }
  // Three standard deviations of either mean; the second is one of Fisher's F.
  EXPECT_NEAR(chi, 1, 3 * std::sqrt(2 / (kDegrees - 9) / kSessions));
  EXPECT_NEAR(error, kDegrees / (kDegrees - 2),
              3 * std::sqrt((2.0 / 9 + 2 / kDegrees) / kSessions));
}

struct Refused {
  std::vector<std::string> fix;
  bool initial;
  const char* says;
};

TEST(Initial, WhatCannotBeIsRefused) {
  Random random(6);
  const Camera camera = scenes::random_camera("brown4", random);
  const std::vector<Refused> cases = {
      {{"fx"}, false, "initial"},
      {{"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}, true, "nothing left"},
      {{"k1=k2", "k2=k1"}, false, "circle"},
      {{"k1=k1"}, false, "tied already"},
      {{"aspect", "fx=fy"}, false, "tied already"},
      {{"k2", "k1=k2"}, false, "both fixed and tied"},
      {{"k1=k9"}, false, "k1, k2"},
      {{"k9"}, false, "aspect, center"},
  };
  for (const Refused& c : cases) {
    SolveOptions options = from(camera, c.fix);
    if (!c.initial) options.initial.reset();
    const Status status = check(options);
    ASSERT_FALSE(status) << c.says;
    EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(status.error().message.find(c.says), std::string::npos) << status.error().message;
  }
  const auto scaled = solve(views_of(camera, random, 5), kSize, from(camera.scaled({640, 480})));
  ASSERT_FALSE(scaled);
  EXPECT_NE(scaled.error().message.find("640x480"), std::string::npos);
}

}  // namespace
}  // namespace calvin
