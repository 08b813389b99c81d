// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The solve: honest covariance, plain least squares, outliers, and what is left out.
#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "calvin/solve/solve.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

constexpr double kNoise = 0.1;  // px

std::vector<View> make_views(const Camera& camera, Random& random, int count,
                             double max_tilt = std::numbers::pi / 4) {
  return scenes::observe_all(camera, kBoard,
                             scenes::random_poses(camera, kBoard, random, count, max_tilt), kNoise,
                             random);
}

SolveOptions with_model(std::string_view model) {
  SolveOptions options;
  options.model = model;
  return options;
}

// About xi = 0, where ordinary lenses are, no views tell xi from alpha and the focal length. That
// is not the fault of whoever holds the board.
TEST(DoubleSphere, IsRefusedByItsNameForALensThatItCannotTell) {
  const Camera camera = default_camera(kSize);
  for (const unsigned seed : {1, 2, 3, 4, 5, 6}) {
    Random random(seed);
    const auto views = make_views(camera, random, 25);
    SolveOptions options = with_model("doublesphere");
    const auto solution = solve(views, kSize, options);
    if (solution) {  // by what is left of it without xi
      EXPECT_EQ(solution->calibration.model, "ucm");
      EXPECT_NE(solution->calibration.remarks.at(0).find("model doublesphere"), std::string::npos);
    }
    options.checks = false;
    const auto by_itself = solve(views, kSize, options);
    ASSERT_FALSE(by_itself.has_value());
    EXPECT_NE(by_itself.error().message.find("coefficients of doublesphere apart"),
              std::string::npos)
        << by_itself.error().message;
  }
}

class EveryModel : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Solve, EveryModel, ::testing::ValuesIn(scenes::kSolvedModels),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(EveryModel, CovarianceTellsTheErrorAgainstTheTruth) {
  Random random(1);
  const int trials = scenes::full_count() ? 500 : 20;
  double sum = 0;
  double scale = 0;
  for (int i = 0; i < trials; ++i) {
    const Camera camera = scenes::random_camera(GetParam(), random);
    const auto views = make_views(camera, random, 25);
    const auto solution = solve(views, kSize, with_model(GetParam()));
    ASSERT_TRUE(solution.has_value()) << "trial " << i << ": " << solution.error().message;
    EXPECT_TRUE(solution->rejected.empty()) << "trial " << i;
    const double error = scenes::normalised_error(solution->calibration, camera);
    EXPECT_LT(error, 8) << "trial " << i;
    sum += error / trials;
    scale += *solution->calibration.rms / (kNoise * std::sqrt(2.0)) / trials;
  }
  const double tolerance = scenes::full_count() ? 0.1 : 0.4;
  EXPECT_NEAR(sum, 1, tolerance + (scenes::full_count() ? 0 : 0.2 * (sum > 1)));
  // 1350 corners and at most 159 unknowns.
  EXPECT_NEAR(scale, std::sqrt(1 - 159 / 2700.0), 0.01);
}

TEST_P(EveryModel, ExactCornersGiveTheExactCamera) {
  Random random(2);
  const Camera camera = scenes::random_camera(GetParam(), random);
  const auto poses = scenes::random_poses(camera, kBoard, random, 8);
  const auto views = scenes::observe_all(camera, kBoard, poses, 0, random);
  const auto solution = solve(views, kSize, with_model(GetParam()));
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  for (std::size_t i = 0; i < camera.parameters().size(); ++i) {
    const double truth = camera.parameters()[i];
    EXPECT_NEAR(solution->calibration.parameters[i].value, truth, 1e-7 * (1 + std::abs(truth)));
  }
  for (std::size_t v = 0; v < poses.size(); ++v) {
    const SE3 found = to_se3(solution->calibration.views[v].camera_from_board);
    EXPECT_LT((found.translation - poses[v].translation).norm(), 1e-8);
    EXPECT_LT((found.rotation - poses[v].rotation).norm(), 1e-8);
  }
}

TEST_P(EveryModel, FewAndFlatViewsFindTheSameMinimumAsAStartFromTheTruth) {
  // The truth itself cannot be the start, but a minimum in the wrong basin is far above the noise.
  Random random(3);
  for (const auto& [count, tilt] : std::vector<std::pair<int, double>>{{3, 0.8}, {5, 0.35}}) {
    for (int i = 0; i < 10; ++i) {
      const Camera camera = scenes::random_camera(GetParam(), random);
      const auto views = make_views(camera, random, count, tilt);
      const auto solution = solve(views, kSize, with_model(GetParam()));
      if (!solution) {
        EXPECT_EQ(solution.error().code, ErrorCode::kDegenerate);
        EXPECT_NE(solution.error().message.find("+-"), std::string::npos)
            << solution.error().message;
        continue;
      }
      EXPECT_LT(*solution->calibration.rms, 1.2 * kNoise * std::sqrt(2.0)) << count << ", " << i;
      EXPECT_TRUE(solution->rejected.empty());
    }
  }
}

class Solve : public ::testing::Test {
 protected:
  Random random_{7};
  Camera camera_ = scenes::random_camera("brown5", random_);

  void expect_within(const Calibration& c, double sigmas) const {
    for (std::size_t i = 0; i < camera_.parameters().size(); ++i) {
      const Parameter& p = c.parameters[i];
      ASSERT_TRUE(p.sigma.has_value());
      EXPECT_LT(std::abs(p.value - camera_.parameters()[i]), sigmas * *p.sigma) << p.name;
    }
  }
};

TEST_F(Solve, DescribesWhatItUsed) {
  auto views = make_views(camera_, random_, 12);
  views[0].observation.camera = "left";
  const auto solution = solve(views, kSize);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  const Calibration& c = solution->calibration;
  EXPECT_EQ(c.camera, "left");
  EXPECT_EQ(c.model, "brown5");
  EXPECT_EQ(c.board, "checkerboard:9x6:25mm");
  EXPECT_TRUE(c.created.empty());
  ASSERT_TRUE(c.held_out_rms && c.chi);
  EXPECT_NEAR(*c.chi, 1, 0.1);
  EXPECT_GT(*c.held_out_rms, *c.rms);
  ASSERT_EQ(c.views.size(), 12u);
  EXPECT_EQ(c.views[3].timestamp, 4000u);
  EXPECT_EQ(c.views[3].points, 54);
  EXPECT_EQ(c.covariance.size(), 81u);
  EXPECT_NEAR(std::sqrt(c.covariance[10]), *c.parameters[1].sigma, 1e-12);
  EXPECT_GE(c.covered.size(), 4u);
  EXPECT_TRUE(c.expected_error && *c.expected_error > 0 && *c.expected_error < 1);
  double squares = 0;
  for (const ViewRecord& view : c.views) squares += view.rms * view.rms * view.points;
  EXPECT_NEAR(std::sqrt(squares / (12 * 54)), *c.rms, 1e-12);
}

TEST_F(Solve, OneSigmaForAllIsPlainLeastSquares) {
  auto views = make_views(camera_, random_, 12);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto with = [&](double sigma) {
    for (View& view : views) std::fill_n(view.observation.sigma.begin(), 54, sigma);
    return solve(views, kSize).value().calibration;
  };
  // Less than the residuals show, or nothing: they tell the noise. More: the detector does.
  const Calibration plain = with(kUnknown);
  for (const double sigma : {kNoise / 10, -1.0, 3 * kNoise, 10 * kNoise}) {
    const Calibration other = with(sigma);
    const double factor = sigma > kNoise ? sigma / kNoise : 1;
    for (std::size_t i = 0; i < 9; ++i) {
      const double expected = *plain.parameters[i].sigma;
      EXPECT_NEAR(other.parameters[i].value, plain.parameters[i].value, 0.05 * expected);
      EXPECT_NEAR(*other.parameters[i].sigma / factor, expected, 0.1 * expected);
    }
    EXPECT_EQ(other.chi.has_value(), sigma > 0);
    EXPECT_NEAR(other.chi.value_or(kNoise / sigma) * sigma, kNoise, 0.1 * kNoise);
  }
}

TEST_F(Solve, SigmasWeighTheCornersAndTheCovarianceStaysHonest) {
  double plain = 0;
  double weighted = 0;
  constexpr int kTrials = 20;
  for (int i = 0; i < kTrials; ++i) {
    auto views = make_views(camera_, random_, 15);
    // Every second view is five times as noisy.
    std::normal_distribution<double> noise(0, std::sqrt(24.0) * kNoise);
    for (std::size_t v = 0; v < views.size(); v += 2) {
      for (Pixel& p : views[v].observation.uv) {
        p = {p.u + noise(random_), p.v + noise(random_)};
      }
      for (double& s : views[v].observation.sigma) s = 5 * kNoise;
    }
    SolveOptions options;
    options.reject_outliers = false;
    const auto good = solve(views, kSize, options);
    for (View& view : views) view.observation.sigma.clear();
    const auto bad = solve(views, kSize, options);
    ASSERT_TRUE(good && bad);
    weighted += scenes::normalised_error(good->calibration, camera_) / kTrials;
    plain += *bad->calibration.find("fx")->sigma / *good->calibration.find("fx")->sigma / kTrials;
  }
  EXPECT_GT(weighted, 0.6);
  EXPECT_LT(weighted, 1.6);
  EXPECT_GT(plain, 1.5);
}

TEST_F(Solve, GrossCornersAndAWrongViewAreFoundAndNamed) {
  for (int trial = 0; trial < 5; ++trial) {
    auto views = make_views(camera_, random_, 20);
    std::size_t gross = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (v == 11) continue;
      for (Pixel& p : views[v].observation.uv) {
        if (scenes::uniform(random_, 0, 1) > 0.02) continue;
        const double angle = scenes::uniform(random_, 0, 6.28);
        const double far = scenes::uniform(random_, 5, 60);
        p.u = std::clamp(p.u + far * std::cos(angle), 0.0, kSize.width - 1.0);
        p.v = std::clamp(p.v + far * std::sin(angle), 0.0, kSize.height - 1.0);
        ++gross;
      }
    }
    // Rows and columns exchanged: no pose explains it.
    auto& wrong = views[11].observation;
    for (int& id : wrong.ids) id = (id % 6) * 9 + (id / 6) % 9;
    const auto solution = solve(views, kSize);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    ASSERT_EQ(solution->rejected.size(), 1u);
    EXPECT_EQ(solution->rejected[0].index, 11u);
    EXPECT_EQ(solution->rejected[0].reason, Reason::kOutlier);
    EXPECT_GE(solution->rejected_corners.size(), gross * 9 / 10);
    EXPECT_LE(solution->rejected_corners.size(), gross);
    expect_within(solution->calibration, 4);
  }
}

TEST_P(EveryModel, CornersAnywhereInTheImageSpoilNothing) {
  Random random(31);
  for (int trial = 0; trial < 3; ++trial) {
    const Camera camera = scenes::random_camera(GetParam(), random);
    auto views = make_views(camera, random, 15);
    for (View& view : views) {
      for (std::size_t i = 0; i < 5; ++i) {
        view.observation.uv[i * 11] = {scenes::uniform(random, 0, kSize.width - 1.0),
                                       scenes::uniform(random, 0, kSize.height - 1.0)};
      }
    }
    const auto solution = solve(views, kSize, with_model(GetParam()));
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    EXPECT_TRUE(solution->rejected.empty());
    EXPECT_EQ(solution->rejected_corners.size(), 15u * 5u);
    for (const RejectedCorner& corner : solution->rejected_corners) EXPECT_EQ(corner.id % 11, 0);
    EXPECT_LT(scenes::normalised_error(solution->calibration, camera), 5);
  }
}

TEST_F(Solve, GoodCornersAreNotRejected) {
  std::size_t lost = 0;
  for (int i = 0; i < 20; ++i) {
    const auto solution = solve(make_views(camera_, random_, 25), kSize);
    ASSERT_TRUE(solution.has_value());
    lost += solution->rejected.size() + solution->rejected_corners.size();
  }
  EXPECT_EQ(lost, 0u);
}

TEST_F(Solve, FixHoldsParameters) {
  SolveOptions options;
  options.fix = {"k3", "center", "aspect", "p1", "p2"};
  const auto views = make_views(camera_, random_, 10);
  const auto solution = solve(views, kSize, options);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  const Calibration& c = solution->calibration;
  EXPECT_EQ(c.find("k3")->value, 0);
  EXPECT_EQ(c.find("cx")->value, (kSize.width - 1) / 2.0);
  EXPECT_EQ(c.find("fx")->value, c.find("fy")->value);
  EXPECT_EQ(c.find("fx")->sigma, c.find("fy")->sigma);
  EXPECT_FALSE(c.find("cy")->sigma || c.find("p1")->sigma);
  EXPECT_TRUE(c.find("k2")->sigma.has_value());
  EXPECT_EQ(c.covariance.size(), 16u);
  EXPECT_TRUE(c.expected_error.has_value());

  options.fix = {"k4"};
  const auto unknown = solve(views, kSize, options);
  ASSERT_FALSE(unknown.has_value());
  EXPECT_NE(unknown.error().message.find("aspect"), std::string::npos);
}

TEST_F(Solve, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  const auto solution = solve(make_views(camera_, random_, 10), kSize, {}, source.get_token());
  ASSERT_FALSE(solution.has_value());
  EXPECT_EQ(solution.error().code, ErrorCode::kCancelled);
}

TEST_F(Solve, ASecondViewOfAPoseDoesNoHarm) {
  auto views = make_views(camera_, random_, 8);
  views.push_back(views[3]);
  const auto solution = solve(views, kSize);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  expect_within(solution->calibration, 5);
}

TEST_F(Solve, UselessViewsAreLeftOutAndNamed) {
  auto views = make_views(camera_, random_, 12);
  views[1].observation.ids.clear();
  views[1].observation.uv.clear();
  views[4].observation.image_size = {640, 480};
  views[6].observation.ids.resize(9);
  views[6].observation.uv.resize(9);
  const auto solution = solve(views, kSize);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  ASSERT_EQ(solution->rejected.size(), 3u);
  EXPECT_EQ(solution->rejected[0].reason, Reason::kNotFound);
  EXPECT_EQ(solution->rejected[1].reason, Reason::kOffSize);
  EXPECT_EQ(solution->rejected[2].reason, Reason::kTooFewPoints);
  EXPECT_EQ(solution->rejected[2].index, 6u);
  EXPECT_EQ(solution->calibration.views.size(), 9u);
}

// A readout that is given moves corners by their velocities, which frames without times have not.
TEST_F(Solve, SaysThatAReadoutHasNoEffectWhereNothingMoves) {
  scenes::Random random(3);
  const Camera camera = scenes::random_camera("brown4", random);
  auto views =
      scenes::observe_all(camera, scenes::kBoard,
                          scenes::random_poses(camera, scenes::kBoard, random, 12), 0.05, random);
  const auto says_so = [&views](std::optional<ReadoutTime> readout) {
    SolveOptions options;
    options.model = "brown4";
    options.readout = readout;
    const auto solution = solve(views, scenes::kSize, options);
    EXPECT_TRUE(solution.has_value());
    return solution && std::ranges::any_of(solution->calibration.remarks, [](const auto& remark) {
             return remark.find("readout time has no effect") != std::string::npos;
           });
  };
  EXPECT_TRUE(says_so(ReadoutTime{0.02, 0}));
  EXPECT_FALSE(says_so(ReadoutTime{0, 0.03})) << "nobody has given one";
  EXPECT_FALSE(says_so(ReadoutTime{1e-9, 0})) << "all rows at once";
  EXPECT_FALSE(says_so({}));
  views[3].observation.velocity.assign(views[3].observation.uv.size(), {1, 2});
  EXPECT_FALSE(says_so(ReadoutTime{0.02, 0}));
}

}  // namespace
}  // namespace calvin
