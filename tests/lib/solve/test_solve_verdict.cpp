// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rules by which a solve judges corners, views and itself, each against numbers worked out by
// hand or taken from tables.
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/judge/fit_diagnostics.hpp"
#include "calvin/solve/judge/remarks.hpp"
#include "calvin/solve/residuals/loss.hpp"
#include "calvin/solve/residuals/outliers.hpp"
#include "calvin/solve/solve.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using Cause = Misfit::Cause;

// Quantiles of chi^2 (Abramowitz and Stegun, table 26.8), which a normal number exceeds as rarely
// at 2.3263, 1.6449, 0 and -1.6449.
TEST(ChiSquare, IsInStandardDeviations) {
  EXPECT_NEAR((ChiSquare{23.2093, 10}.deviations()), 2.3263, 0.02);
  EXPECT_NEAR((ChiSquare{76.1539, 50}.deviations()), 2.3263, 0.005);
  EXPECT_NEAR((ChiSquare{67.5048, 50}.deviations()), 1.6449, 0.005);
  EXPECT_NEAR((ChiSquare{99.3341, 100}.deviations()), 0, 0.005);
  EXPECT_NEAR((ChiSquare{77.9295, 100}.deviations()), -1.6449, 0.005);
  EXPECT_EQ((ChiSquare{3, 0}.deviations()), 0);
  EXPECT_EQ((ChiSquare{3, 2}.ratio()), 1.5);
  EXPECT_EQ((ChiSquare{3, 0}.ratio()), 1);
}

constexpr double kDegrees = 1000;

// A sum that noise exceeds by this many standard deviations: nearly d + s sqrt(2 d).
ChiSquare beyond(double deviations, double degrees = 100) {
  const double width = 2 / (9 * degrees);
  return {degrees * std::pow(1 - width + deviations * std::sqrt(width), 3), degrees};
}

// Statistics on which views agree, or not, by this many standard deviations.
FitDiagnostics statistics(const ChiSquare& views, const ChiSquare& picture, const ChiSquare& board,
                          double agreement = 3) {
  FitDiagnostics result;
  result.views = views;
  result.picture = picture;
  result.board = board;
  result.picture_agrees = agreement;
  result.board_agrees = agreement;
  return result;
}

struct Case {
  const char* name;
  ChiSquare views;
  ChiSquare picture;
  ChiSquare board;
  std::optional<double> chi;
  Cause cause;
  double rms = 0.1;
};

TEST(Verdict, IsTheLargestThatIsSignificant) {
  const ChiSquare noise = {100, 100};
  for (const Case& c : std::vector<Case>{
           {"noise", noise, noise, noise, 1, Cause::kNone},
           {"views", beyond(2.4), noise, noise, 1, Cause::kMotion},
           {"picture", noise, beyond(2.4), noise, 1, Cause::kModel},
           {"board", noise, noise, beyond(2.4), 1, Cause::kBoard},
           {"less than one in a hundred", beyond(2.2), beyond(2.2), beyond(2.2), 1, Cause::kNone},
           {"less than noise", beyond(-4), beyond(-4), beyond(-4), 1, Cause::kNone},
           // The one that explains more, and views contradict each other for either reason.
           {"more of the picture", beyond(5), beyond(4), beyond(3), 1, Cause::kModel},
           {"more of the board", beyond(5), beyond(3), beyond(4), 1, Cause::kBoard},
           {"more of the board, as noise would have", noise, beyond(3, 50), beyond(2, 400), 1,
            Cause::kModel},
           {"chi", noise, noise, noise, 1.4, Cause::kNoise},
           {"chi, a little", noise, noise, noise, 1.3, Cause::kNone},
           {"chi, unknown", noise, noise, noise, {}, Cause::kNone},
           {"chi, and the board", noise, noise, beyond(3), 1.4, Cause::kBoard},
       }) {
    const FitDiagnostics found = statistics(c.views, c.picture, c.board);
    EXPECT_EQ(to_string(misfit(found, c.chi, kDegrees, c.rms, {}).noticed), to_string(c.cause))
        << c.name;
  }
  FitDiagnostics halves = statistics(noise, noise, noise);
  halves.split_half_ratio = 1.5;
  EXPECT_EQ(misfit(halves, 1, kDegrees, 0.1, {}).split_half_ratio, 1.5);
}

// Bends that every view has for itself leave patterns in the picture and on the board too, but in
// each view another one.
TEST(Verdict, OfLensAndBoardIsThatOfAllViewsAlike) {
  const auto noticed = [&](double agreement) {
    return misfit(statistics(beyond(5), beyond(5), beyond(5), agreement), 1, kDegrees, 0.1, {})
        .noticed;
  };
  EXPECT_EQ(noticed(2.4), Cause::kModel);
  EXPECT_EQ(noticed(2.2), Cause::kMotion);
}

// What the covariance has an estimate of is a misfit only where the promise is more than a pixel,
// and more than three times what noise would leave.
TEST(Verdict, WhatWasEstimatedMattersAboveAPixel) {
  const ChiSquare noise = {100, 100};
  const auto cause = [](FitDiagnostics found, double chi, const PromiseParts& promise,
                        bool bends_known) {
    found.bends_known = bends_known;
    return misfit(found, chi, kDegrees, 0.1, promise).cause;
  };
  const FitDiagnostics moved = statistics(beyond(5), noise, noise);
  EXPECT_EQ(cause(moved, 1, {1.1, 1.1 / 2.9, {}}, false), Cause::kNone);
  EXPECT_EQ(cause(moved, 1, {1.1, 1.1 / 3.1, {}}, false), Cause::kMotion);
  EXPECT_EQ(cause(moved, 1, {0.9, 0.9 / 9, {}}, false), Cause::kNone);
  const FitDiagnostics bent = statistics(noise, noise, beyond(5));
  EXPECT_EQ(cause(bent, 1, {1.1, 1.1 / 2.9, {}}, true), Cause::kNone);
  EXPECT_EQ(cause(bent, 1, {1.1, 1.1 / 3.1, {}}, true), Cause::kBoard);
  EXPECT_EQ(cause(bent, 1, {0.9, 0.9 / 9, {}}, true), Cause::kNone);
  EXPECT_EQ(cause(statistics(noise, noise, noise), 9.9, {1.1, 1, {}}, true), Cause::kNone);
  EXPECT_EQ(cause(statistics(noise, noise, noise), 10.1, {1.1, 1, {}}, true), Cause::kNoise);
  EXPECT_EQ(cause(statistics(noise, noise, noise), 10.1, {0.9, 0.8, {}}, true), Cause::kNone);
}

// Nothing estimates a bend that is no unknown. What a lens lacks is at least what it leaves in the
// residuals.
TEST(Verdict, WhatThePromiseDoesNotHoldIsAMisfitOfAnySize) {
  const ChiSquare noise = {100, 100};
  const FitDiagnostics bent = statistics(noise, noise, beyond(5));
  EXPECT_EQ(misfit(bent, 1, kDegrees, 0.1, {0.2, 0.2, {}}).cause, Cause::kBoard);
  // 100 of 1000: 0.0316 px of an rms of 0.1 px.
  const FitDiagnostics lens = statistics(noise, {200, 100}, noise);
  EXPECT_NEAR(misfit(lens, 1, kDegrees, 0.1, {}).lens_residual, 0.0316, 1e-4);
  EXPECT_EQ(misfit(lens, 1, kDegrees, 0.1, {0.030, 0.030, {}}).cause, Cause::kModel);
  EXPECT_EQ(misfit(lens, 1, kDegrees, 0.1, {0.033, 0.033, {}}).cause, Cause::kNone);
}

// No sheet of paper is off by so much: the text is of another board.
TEST(Verdict, CornersFarFromWhereTheTextHasThemAreAMisfit) {
  const ChiSquare noise = {100, 100};
  FitDiagnostics off = statistics(noise, noise, {900, 100});
  off.bends_known = true;
  const PromiseParts promise = {0.2, 0.2, {}};
  // 800 of 1000, of an rms of 1.1 and 1.2 px.
  EXPECT_EQ(misfit(off, 1, kDegrees, 1.1, promise).cause, Cause::kNone);
  const Misfit found = misfit(off, 1, kDegrees, 1.2, promise);
  EXPECT_EQ(found.cause, Cause::kBoard);
  EXPECT_NEAR(found.board_residual, 1.2 * std::sqrt(0.8), 1e-9);
  EXPECT_NE(
      explain(found, off, 1, promise).find("in all views alike, by 1.1 px. See that its sides"),
      std::string::npos);
}

// Blamed is what the promise would be without.
TEST(Verdict, IsTheBoardOnlyWhereAMeasuredOneWouldHelp) {
  const ChiSquare noise = {100, 100};
  FitDiagnostics off = statistics(beyond(5), noise, beyond(5));
  off.bends_known = true;
  const auto cause = [&off](double measured) {
    return misfit(off, 1, kDegrees, 0.1, {2, 0.5, measured}).cause;
  };
  EXPECT_EQ(cause(1.40), Cause::kBoard);
  EXPECT_EQ(cause(1.43), Cause::kMotion);
}

TEST(Remarks, SayWhatWasFoundHowMuchItMattersAndWhatHelps) {
  const ChiSquare noise = {100, 100};
  FitDiagnostics off = statistics(noise, noise, beyond(5));
  off.bends_known = true;
  off.board_variance = 57e-6 * 57e-6;
  const PromiseParts promise = {0.36, 0.175, 0.17};
  const Misfit found = misfit(off, 2.7, kDegrees, 0.1, promise);
  EXPECT_FALSE(found.found());
  EXPECT_EQ(explain(found, off, 2.7, promise),
            "The corners of the board are 0.057 mm from where they were printed. That is in the "
            "accuracy of 0.72 px, which a measured or stiffer board would bring to 0.34 px.");
  const PromiseParts large = {3.6, 0.175, 0.17};
  EXPECT_EQ(explain(misfit(off, 2.7, kDegrees, 0.1, large), off, 2.7, large),
            "The corners of the board are 0.057 mm from where they were printed. That is in the "
            "accuracy of 7.2 px, which a measured or stiffer board would bring to 0.34 px. Fix the "
            "board to a stiff plate and measure its squares.");
  const FitDiagnostics nothing = statistics(noise, noise, noise);
  EXPECT_EQ(explain(misfit(nothing, 1, kDegrees, 0.1, promise), nothing, 1, promise), "");
}

// A hundredth of the variance, and three thousandths of a pixel.
TEST(Verdict, IsNotSaidOfWhatDoesNotMatter) {
  const auto cause = [](double excess, double all, double rms) {
    const ChiSquare noise = {100, 100};
    return misfit(statistics(noise, {100 + excess, 100}, noise), {}, all, rms, {}).noticed;
  };
  EXPECT_EQ(cause(50, 4900, 0.1), Cause::kModel);  // 0.0102 of the variance
  EXPECT_EQ(cause(50, 5100, 0.1), Cause::kNone);   // 0.0098
  // sqrt(0.05) of the rms.
  EXPECT_EQ(cause(50, 1000, 0.014), Cause::kModel);
  EXPECT_EQ(cause(50, 1000, 0.013), Cause::kNone);
}

// The limit of chi is 1.25 (1 + 2.33 / sqrt(2 degrees)): 1.3415 at a thousand, 1.541 at fifty.
TEST(Verdict, OfNoiseAllowsForTheLuckOfFewCorners) {
  const ChiSquare none = {0, 0};
  const auto cause = [&](double chi, double degrees) {
    return misfit(statistics(none, none, none), chi, degrees, 0.1, {}).noticed;
  };
  EXPECT_EQ(cause(1.31, kDegrees), Cause::kNone);
  EXPECT_EQ(cause(1.33, kDegrees), Cause::kNoise);
  EXPECT_EQ(cause(1.53, 50), Cause::kNone);
  EXPECT_EQ(cause(1.55, 50), Cause::kNoise);
}

TEST(RobustScale, IsTheMedianOfRayleighs) {
  // The median distance of Gaussian points from their mean is sqrt(2 ln 2) sigma.
  EXPECT_NEAR(robust_scale({9, 0.1, 1, 0.9, 50}), 1 / std::sqrt(2 * std::numbers::ln2), 1e-4);
  EXPECT_EQ(robust_scale({1e-3, 1e-3, 1e-3}), 0.01);
  EXPECT_EQ(robust_scale({}), 0.01);
}

TEST(TrimmedRms, IsOfTheNearestThreeQuarters) {
  EXPECT_NEAR(trimmed_rms({100, 1, 2, 3}), std::sqrt(14.0 / 3), 1e-12);
  EXPECT_NEAR(trimmed_rms({100, 100, 4, 1, 2, 3, 1, 1}), std::sqrt(32.0 / 6), 1e-12);
  EXPECT_NEAR(trimmed_rms({5}), 5, 1e-12);
  EXPECT_EQ(trimmed_rms({}), 0);
}

constexpr double kRayleigh = 1.1774;

// A view of which the scale is `scale`.
std::vector<double> view_of(double scale) { return std::vector<double>(9, scale * kRayleigh); }

TEST(Outliers, CornersBeyondSixScales) {
  std::vector<std::vector<double>> distances(3, view_of(1));
  distances[1][4] = 5.99;
  distances[1][5] = 6.01;
  distances[2] = view_of(2);  // judged by itself
  distances[2][0] = 11.98;
  distances[2][1] = 12.02;
  const auto masks = find_outliers(distances);
  ASSERT_EQ(masks.size(), 3U);
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_TRUE(masks[v].view);
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_EQ(masks[v].corners[i], !(v == 1 && i == 5) && !(v == 2 && i == 1)) << v << " " << i;
    }
  }
  EXPECT_TRUE(any_outlier(masks));
  // A view that is better than the others has no narrower limit.
  distances.assign(3, view_of(1));
  distances[0] = view_of(0.1);
  distances[0][3] = 5.9;
  EXPECT_FALSE(any_outlier(find_outliers(distances)));
}

TEST(Outliers, ViewsBeyondFourTimesTheMedian) {
  const auto judged = [](double scale, std::size_t others) {
    std::vector<std::vector<double>> distances(others, view_of(1));
    distances.push_back(view_of(scale));
    return find_outliers(distances).back();
  };
  EXPECT_TRUE(judged(3.9, 5).view);
  EXPECT_FALSE(judged(4.1, 5).view);
  for (const bool corner : judged(4.1, 5).corners) EXPECT_FALSE(corner);
  EXPECT_FALSE(judged(4.1, 3).view);
  EXPECT_TRUE(judged(4.1, 2).view);  // three views judge none
}

TEST(Outliers, ViewsThatDifferMuchAreLeftTheirWay) {
  // Scales of median 1.6 and 1.4826 times the median deviation of 0.6: the limit is 6.94.
  const auto judged = [](double scale) {
    std::vector<std::vector<double>> distances;
    for (const double s : {0.1, 1.0, 1.0, 1.6, 1.6, 2.2, 2.2, 0.1}) distances.push_back(view_of(s));
    distances.push_back(view_of(scale));
    return find_outliers(distances).back().view;
  };
  EXPECT_TRUE(judged(6.85));
  EXPECT_FALSE(judged(7.0));
}

TEST(Losses, AreTheirFormulae) {
  const Loss huber = {Loss::Kind::kHuber, 2};
  EXPECT_EQ(huber(3.9).cost, 3.9);
  EXPECT_EQ(huber(3.9).weight, 1);
  EXPECT_NEAR(huber(25).cost, 2 * 2 * 5 - 4, 1e-12);
  EXPECT_NEAR(huber(25).weight, 0.4, 1e-12);
  const Loss cauchy = {Loss::Kind::kCauchy, 2};
  EXPECT_NEAR(cauchy(12).cost, 4 * std::log(4.0), 1e-12);
  EXPECT_NEAR(cauchy(12).weight, 0.25, 1e-12);
  EXPECT_EQ(Loss{}(25).cost, 25);
  EXPECT_EQ(Loss{}(25).weight, 1);
}

PointSet points_of(std::vector<double> sigmas, bool known = true) {
  PointSet set;
  for (const double sigma : sigmas) set.weight.push_back(1 / sigma);
  set.points.resize(sigmas.size());
  set.sigma_known = known;
  return set;
}

TEST(Weights, AreOfTheMedianSigma) {
  std::vector<PointSet> views = {points_of({0.1, 0.2}), points_of({0.2, 0.4, 1000})};
  const WeightScale scale = normalise_weights(views);
  EXPECT_NEAR(scale.sigma, 0.2, 1e-15);
  EXPECT_TRUE(scale.known);
  EXPECT_NEAR(views[0].weight[0], 2, 1e-12);
  EXPECT_NEAR(views[0].weight[1], 1, 1e-12);
  EXPECT_NEAR(views[1].weight[1], 0.5, 1e-12);
  EXPECT_NEAR(views[1].weight[2], 1e-3, 1e-12);  // no further than that
  views = {points_of({0.1}), points_of({0.1}, false), points_of({0.1})};
  EXPECT_FALSE(normalise_weights(views).known);
}

// Distances of which the median square is `times` 2 ln 2 (the median of two Gaussians' squares).
Fit fit_of(const std::vector<double>& sigmas, const std::vector<double>& squares) {
  Fit fit;
  fit.used = {true};
  fit.views = {points_of(sigmas)};
  fit.squares = {squares};
  return fit;
}

TEST(CommonSigma, IsWhatTheMedianAsksFor) {
  constexpr double kMedian = 2 * std::numbers::ln2;
  const WeightScale scale = {0.1, true};
  const auto found = [&](const std::vector<double>& sigmas, const std::vector<double>& squares) {
    Weights original(1);
    for (const double s : sigmas) original[0].push_back(scale.sigma / s);
    return common_sigma(fit_of(sigmas, squares), original, scale, {});
  };
  // Every corner is off by what sigma_i^2 + 0.3^2 gives in the median.
  const std::vector<double> sigmas = {0.05, 0.1, 0.2, 0.1, 0.4};
  std::vector<double> squares;
  for (const double s : sigmas) squares.push_back(kMedian * (s * s + 0.09));
  EXPECT_NEAR(found(sigmas, squares), 0.3, 1e-6);
  // Up to half of them may be anything.
  squares[0] = 1e6;
  squares[4] = 0;
  EXPECT_NEAR(found(sigmas, squares), 0.3, 1e-6);
  // Corners that are as good as they say, or all say the same.
  squares.clear();
  for (const double s : sigmas) squares.push_back(0.99 * kMedian * s * s);
  EXPECT_EQ(found(sigmas, squares), 0);
  EXPECT_EQ(found({0.1, 0.1, 0.102}, {1, 1, 1}), 0);
  EXPECT_GT(found({0.1, 0.1, 0.104}, {1, 1, 1}), 0);  // 8 % of the variance
}

// Six corners in the middle of the board claim a hundredth of their noise, all others a third of
// it. The first fit follows the six, so that everything else lies far off; the common sigma is that
// of a later one, and with it the sigma of the camera is that of corners whose noise is known.
TEST(CommonSigma, IsThatOfTheLastFit) {
  constexpr double kNoise = 0.3;  // px
  for (int seed = 1; seed < 7; ++seed) {
    scenes::Random random(static_cast<std::uint64_t>(seed));
    const Camera camera = scenes::random_camera("pinhole", random);
    auto views = scenes::observe_all(camera, scenes::kBoard,
                                     scenes::random_poses(camera, scenes::kBoard, random, 12),
                                     kNoise, random);
    SolveOptions options;
    options.model = "pinhole";
    options.warp = false;
    options.checks = false;
    options.reject_outliers = false;
    const auto fx_sigma = [&](double of_six, double of_others) {
      for (View& view : views) {
        view.observation.sigma.assign(54, of_others);
        for (const std::size_t i : {21, 22, 23, 30, 31, 32}) view.observation.sigma[i] = of_six;
      }
      return *solve(views, scenes::kSize, options).value().calibration.find("fx")->sigma;
    };
    EXPECT_NEAR(fx_sigma(kNoise / 100, kNoise / 3) / fx_sigma(kNoise, kNoise), 1, 0.15) << seed;
  }
}

TEST(CommonSigma, IsAddedToTheSquares) {
  const WeightScale scale = {0.2, true};
  const auto views = with_common_sigma({points_of({1, 1})}, {{1, 0.5}}, scale, 0.15);
  // Of sigmas 0.2 and 0.4, with 0.15: 0.25 and 0.4272, in units of 0.2.
  EXPECT_NEAR(views[0].weight[0], 0.8, 1e-12);
  EXPECT_NEAR(views[0].weight[1], 0.2 / std::hypot(0.4, 0.15), 1e-12);
}

}  // namespace
}  // namespace calvin
