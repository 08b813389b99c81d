// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a solve knows when it is wrong: boards that are bent, lenses richer than the model, views
// that moved, errors that corners have in common; and sessions in which nothing is amiss.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "calvin/solve/difference.hpp"
#include "calvin/solve/uncertainty.hpp"
#include "faulty_session.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Fault;
using scenes::kNoise;
using scenes::Random;
using scenes::session;

int sessions() { return scenes::full_count() ? 200 : 25; }

// How a board bends along its long side, by `depth` m in the middle.
std::function<Eigen::Vector3d(const Eigen::Vector3d&)> bow(double depth,
                                                           const Board& board = scenes::kBoard) {
  return [depth, length = board.extent().width()](const Eigen::Vector3d& p) {
    const double x = 2 * p.x() / length - 1;
    return Eigen::Vector3d(p.x(), p.y(), depth * (1 - x * x));
  };
}

// The part of sessions in which something is noticed; `causes` counts what. The user is told of it
// in a remark, and as a misfit where the promise does not have it.
double flagged(const std::string& truth, const std::string& model, const Fault& fault, bool warp,
               std::map<std::string, int>* causes = nullptr) {
  Random random(11);
  int found = 0;
  for (int i = 0; i < sessions(); ++i) {
    const Camera camera = scenes::random_camera(truth, random);
    SolveOptions options;
    options.model = model;
    options.warp = warp;
    const auto solution = solve(session(camera, fault, random), camera.image_size(), options);
    if (!solution) {
      ++found;
      continue;
    }
    if (causes != nullptr) ++(*causes)[std::string(to_string(solution->misfit.noticed))];
    found += solution->misfit.noticed != Misfit::Cause::kNone ? 1 : 0;
  }
  return static_cast<double>(found) / sessions();
}

// 5 % of perfect sessions may be flagged; three more standard deviations are the luck of the draw.
double most_false() { return 0.05 + 3 * std::sqrt(0.05 * 0.95 / sessions()); }
double fewest_found() { return 0.95 - 3 * std::sqrt(0.05 * 0.95 / sessions()); }

class Perfect : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Checks, Perfect, ::testing::Values("pinhole", "brown5", "fisheye"));

TEST_P(Perfect, SessionsAreNotFlagged) {
  std::map<std::string, int> causes;
  for (const bool warp : {false, true}) {
    EXPECT_LE(flagged(GetParam(), GetParam(), {}, warp, &causes), most_false()) << warp;
  }
  for (const auto& [cause, count] : causes) {
    RecordProperty(cause, count);
  }
}

// A detector is a little too sure of its corners, and wrong alike in all of a view: nobody's fault.
TEST(Checks, WhatADetectorMayGetWrongIsNotFlagged) {
  constexpr double kSigma = 0.005;
  const Fault fault = {{}, [](View& view, Random& random) {
                         const double du = scenes::uniform(random, -0.003, 0.003);
                         const double dv = scenes::uniform(random, -0.003, 0.003);
                         for (std::size_t i = 0; i < view.observation.uv.size(); ++i) {
                           Pixel& p = view.observation.uv[i];
                           p = {p.u + du * std::sin(p.v / 60), p.v + dv * std::sin(p.u / 60)};
                           view.observation.sigma[i] = 0.85 * kSigma;
                         }
                       }};
  Random random(17);
  const Camera camera = scenes::random_camera("brown5", random);
  int found = 0;
  for (int i = 0; i < sessions(); ++i) {
    const auto solution = solve(session(camera, fault, random, kSigma), camera.image_size(), {});
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    found += solution->misfit.found() ? 1 : 0;
  }
  EXPECT_LE(static_cast<double>(found) / sessions(), most_false());
}

TEST(Checks, ABowedBoardIsFlagged) {
  for (const double depth : {0.3e-3, 1e-3}) {
    std::map<std::string, int> causes;
    EXPECT_GE(flagged("brown5", "brown5", {bow(depth), {}}, false, &causes), fewest_found())
        << depth;
    // And the board is what is blamed for it.
    EXPECT_GE(causes["board"], 0.8 * sessions()) << depth;
  }
}

// Corners of one id on two boards are two corners: boards that bend against each other are bent.
TEST(Checks, TwoBoardsAreJudgedEachByItself) {
  const Board large = Checkerboard{9, 6, 0.03};
  for (const double depth : {0.0, 0.5e-3}) {
    Random random(19);
    int found = 0;
    for (int i = 0; i < sessions(); ++i) {
      const Camera camera = scenes::random_camera("brown5", random);
      auto views = session(camera, {bow(depth), {}}, random);
      const auto more = session(camera, {bow(-depth, large), {}}, random, kNoise, large);
      views.insert(views.end(), more.begin(), more.end());
      const auto solution = solve(views, camera.image_size(), {});
      ASSERT_TRUE(solution.has_value()) << solution.error().message;
      found += solution->misfit.cause == Misfit::Cause::kBoard ? 1 : 0;
    }
    if (depth > 0) {
      EXPECT_GE(found, 0.8 * sessions());
    } else {
      EXPECT_LE(found, most_false() * sessions());
    }
  }
}

TEST(Checks, ALensThatIsRicherThanTheModelIsFlagged) {
  std::map<std::string, int> causes;
  EXPECT_GE(flagged("brown5", "pinhole", {}, true, &causes), fewest_found());
}

TEST(Checks, ARollingShutterIsFlagged) {
  const Fault fault = {{}, [](View& view, Random& random) {
                         const double du = scenes::uniform(random, -3, 3);
                         const double dv = scenes::uniform(random, -3, 3);
                         for (Pixel& p : view.observation.uv) {
                           const double when = p.v / scenes::kSize.height - 0.5;
                           p = {p.u + when * du, p.v + when * dv};
                         }
                       }};
  EXPECT_GE(flagged("brown5", "brown5", fault, true), fewest_found());
}

TEST(Checks, ErrorsThatCornersOfAViewShareAreFlagged) {
  // Half of the variance is a smooth wave over the view.
  const Fault fault = {{}, [](View& view, Random& random) {
                         const double length = scenes::uniform(random, 250, 500);
                         const double angle = scenes::uniform(random, 0, 2 * std::numbers::pi);
                         const double phase[2] = {scenes::uniform(random, 0, 6.28),
                                                  scenes::uniform(random, 0, 6.28)};
                         for (Pixel& p : view.observation.uv) {
                           const double at = 2 * std::numbers::pi *
                                             (p.u * std::cos(angle) + p.v * std::sin(angle)) /
                                             length;
                           p = {p.u + std::sqrt(2.0) * kNoise * std::sin(at + phase[0]),
                                p.v + std::sqrt(2.0) * kNoise * std::sin(at + phase[1])};
                         }
                       }};
  EXPECT_GE(flagged("brown5", "brown5", fault, true), fewest_found());
}

TEST(Checks, TheCurvatureOfABoardIsFoundWithinItsSigma) {
  Random random(5);
  double squares = 0;
  double error = 0;
  for (int i = 0; i < sessions(); ++i) {
    const Camera camera = scenes::random_camera("brown5", random);
    const auto solution =
        solve(session(camera, {bow(0.3e-3), {}}, random), camera.image_size(), {});
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    ASSERT_TRUE(solution->calibration.warp && solution->calibration.warp->kx_sigma);
    const BoardWarp& warp = *solution->calibration.warp;
    const double off = (warp.kx - 0.3e-3) / *warp.kx_sigma;
    squares += off * off / sessions();
    EXPECT_LT(std::abs(warp.kx - 0.3e-3), 0.15e-3) << i;
    error += scenes::normalised_error(solution->calibration, camera) / sessions();
  }
  const double spread = 4 * std::sqrt(2.0 / sessions());
  EXPECT_NEAR(squares, 1, spread);
  EXPECT_NEAR(error, 1, spread);  // nine parameters: far inside
}

// A detector that sees no more than its own noise says far less than what paper and print add.
const Fault kTooSure = {{}, [](View& view, Random& random) {
                          for (double& sigma : view.observation.sigma) {
                            sigma = kNoise / 10 * scenes::uniform(random, 0.5, 1.5);
                          }
                        }};

// Views that are each bent a little, as a shutter that rolls over a moved board bends them: the
// residuals hardly grow, and views contradict each other.
const Fault kMoved = {{}, [](View& view, Random& random) {
                        const double du = scenes::uniform(random, -6, 6) * kNoise;
                        const double dv = scenes::uniform(random, -6, 6) * kNoise;
                        const Pixel from = view.observation.uv.front();
                        for (std::size_t i = 0; i < view.observation.uv.size(); ++i) {
                          Pixel& p = view.observation.uv[i];
                          const double x = (p.u - from.u) / 400;
                          const double y = (p.v - from.v) / 400;
                          p = {p.u + du * x * x, p.v + dv * y * y};
                          view.observation.sigma[i] = 1.3 * kNoise;
                        }
                      }};

// The covariance has what is amiss, once: the promise follows from it, and is kept. The worst error
// against the truth is 1.5 squared promises where there is no fault, and 14 here, were the promise
// as it is without one.
TEST(Checks, TheExpectedErrorIsTheOneOfTheFault) {
  for (const bool moved : {false, true}) {
    Random random(6);
    double error = 0;
    int found = 0;
    for (int i = 0; i < sessions(); ++i) {
      const Camera camera = scenes::random_camera("brown5", random);
      SolveOptions options;
      options.warp = false;
      const auto views = session(camera, moved ? kMoved : kTooSure, random);
      const auto solution = solve(views, camera.image_size(), options);
      ASSERT_TRUE(solution && solution->calibration.chi) << i;
      if (solution->misfit.noticed == Misfit::Cause::kNone) continue;
      const Calibration& c = solution->calibration;
      EXPECT_FALSE(c.remarks.empty());
      EXPECT_NEAR(*c.expected_error / expected_error(c).value(), 1, 1e-9);
      EXPECT_NEAR(*c.expected_error_anywhere / expected_error_anywhere(c).value(), 1, 1e-9);
      DifferenceOptions where;
      where.focus = {c.covered};
      const double worst = difference(Camera::make(c).value(), camera, where).value().focus.max;
      error += std::pow(worst / *c.expected_error, 2);
      ++found;
    }
    EXPECT_GE(found, fewest_found() * sessions());
    EXPECT_LT(error / found, 4) << moved;
  }
}

// Corners of very different quality, half of them worse than they say.
TEST(Checks, ACommonSigmaKeepsTheCovarianceHonest) {
  Random random(8);
  double error = 0;
  for (int i = 0; i < sessions(); ++i) {
    const Camera camera = scenes::random_camera("brown4", random);
    SolveOptions options;
    options.model = "brown4";
    options.warp = false;
    auto views = session(camera, {}, random, 0.2);
    std::bernoulli_distribution sharp(0.5);
    std::normal_distribution<double> noise(0, 1);
    for (View& view : views) {
      for (std::size_t k = 0; k < view.observation.uv.size(); ++k) {
        const double own = sharp(random) ? 0.02 : 0.4;
        view.observation.sigma[k] = own;
        Pixel& p = view.observation.uv[k];
        p = {p.u + own * noise(random), p.v + own * noise(random)};
      }
    }
    const auto solution = solve(views, camera.image_size(), options);
    ASSERT_TRUE(solution.has_value());
    error += scenes::normalised_error(solution->calibration, camera) / sessions();
  }
  EXPECT_NEAR(error, 1, 4 * std::sqrt(2.0 / 8 / sessions()));
}

class HeldOut : public ::testing::TestWithParam<Fault> {};
INSTANTIATE_TEST_SUITE_P(Checks, HeldOut, ::testing::Values(Fault{}, kTooSure));

TEST_P(HeldOut, ViewsAreWorseThanThoseThatTookPart) {
  Random random(9);
  for (int i = 0; i < 5; ++i) {
    const Camera camera = scenes::random_camera("brown5", random);
    const auto solution = solve(session(camera, GetParam(), random), camera.image_size(), {});
    ASSERT_TRUE(solution && solution->calibration.held_out_rms);
    // sqrt(2) sigma per corner is what exact knowledge of the camera would leave.
    EXPECT_NEAR(*solution->calibration.held_out_rms, std::sqrt(2.0) * kNoise, 0.15 * kNoise);
    EXPECT_EQ(solution->held_out.size(), solution->calibration.views.size());
  }
}

struct Choice {
  const char* name;
  const char* truth;
  std::vector<std::string> right;
  Fault fault = {};
};
class Auto : public ::testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(
    Model, Auto,
    ::testing::Values(Choice{"pinhole", "pinhole", {"pinhole"}},
                      Choice{"brown5", "brown5", {"brown4", "brown5"}},
                      Choice{"fisheye", "fisheye", {"fisheye"}},
                      Choice{"too_sure", "brown5", {"brown4", "brown5"}, kTooSure}),
    [](const auto& choice) { return std::string(choice.param.name); });

TEST_P(Auto, ChoosesTheSimplestThatIsRight) {
  Random random(12);
  int right = 0;
  const int trials = scenes::full_count() ? 50 : 5;
  for (int i = 0; i < trials; ++i) {
    const Camera camera = scenes::random_camera(GetParam().truth, random);
    SolveOptions options;
    options.model = "auto";
    const auto views = session(camera, GetParam().fault, random);
    const auto solution = solve(views, camera.image_size(), options);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    ASSERT_FALSE(solution->calibration.remarks.empty());
    const auto& models = GetParam().right;
    right += std::count(models.begin(), models.end(), solution->calibration.model);
    EXPECT_NE(solution->calibration.remarks.back().find(solution->calibration.model),
              std::string::npos);
    // A lens that bends lines is none without a coefficient.
    if (std::string_view(GetParam().truth) == "brown5") {
      const std::string& remark = solution->calibration.remarks.back();
      EXPECT_NE(remark.find("pinhole"), std::string::npos) << remark;
    }
  }
  EXPECT_GE(right, 0.8 * trials);
}

TEST(Skew, IsFoundWithinItsSigma) {
  Random random(13);
  double squares = 0;
  for (int i = 0; i < sessions(); ++i) {
    const Camera plain = scenes::random_camera("brown4", random);
    const double truth = scenes::uniform(random, -3, 3);
    const Camera camera =
        Camera::make(plain.model(), plain.image_size(), plain.parameters(), truth).value();
    SolveOptions options;
    options.model = "brown4";
    options.skew = true;
    const auto solution = solve(session(camera, {}, random), camera.image_size(), options);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    const Parameter* skew = solution->calibration.find("skew");
    ASSERT_TRUE(skew != nullptr && skew->sigma);
    squares += std::pow((skew->value - truth) / *skew->sigma, 2) / sessions();
  }
  EXPECT_NEAR(squares, 1, 4 * std::sqrt(2.0 / sessions()));
}

}  // namespace
}  // namespace calvin
