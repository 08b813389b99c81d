// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a solve says of views it was not made from, against solves that really leave them out; of
// other optima; and of what it covered.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/judge/make_solution.hpp"
#include "calvin/solve/pose.hpp"
#include "calvin/solve/solve.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

constexpr double kNoise = 0.1;  // px

// Views of which every third shows a part of the board, and the last is worse than the others.
std::vector<View> views_of(const Camera& camera, int count, Random& random) {
  const auto poses = scenes::random_poses(camera, kBoard, random, count);
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const double noise = i + 1 == count ? 3 * kNoise : kNoise;
    View view = scenes::observe(camera, kBoard, poses[static_cast<std::size_t>(i)], noise, random);
    Observation& o = view.observation;
    o.sigma.assign(o.uv.size(), kNoise);
    if (i % 3 == 0) {
      o.ids.resize(18);
      o.uv.resize(18);
      o.sigma.resize(18);
    }
    views.push_back(std::move(view));
  }
  return views;
}

SolveOptions plain() {
  SolveOptions options;
  options.model = "brown4";
  options.warp = false;
  options.reject_outliers = false;
  return options;
}

// Of a view before a camera of all others, its own pose fitted: three corners' worth of its
// squares are gone with it.
double left_out(const std::vector<View>& views, std::size_t v) {
  std::vector<View> others = views;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(v));
  const Camera camera = Camera::make(solve(others, kSize, plain()).value().calibration).value();
  const Observation& seen = views[v].observation;
  const SE3 pose = solve_pose(camera, kBoard, seen).value();
  double squares = 0;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const auto at =
        camera.project(pose * kBoard.points()[static_cast<std::size_t>(seen.ids[i])]).value();
    squares += std::pow(at.u - seen.uv[i].u, 2) + std::pow(at.v - seen.uv[i].v, 2);
  }
  return squares / (static_cast<double>(seen.ids.size()) - 3);
}

TEST(HeldOut, IsWhatASolveWithoutTheViewFinds) {
  Random random(41);
  const Camera camera = scenes::random_camera("brown4", random);
  const auto views = views_of(camera, 7, random);
  const auto solution = solve(views, kSize, plain());
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  ASSERT_EQ(solution->held_out.size(), views.size());
  double sum = 0;
  double corners = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const double expected = left_out(views, v);
    const auto n = static_cast<double>(views[v].observation.ids.size());
    // To first order: the information at another optimum is another one by a few per cent of the
    // part that the camera has in it.
    EXPECT_NEAR(solution->held_out[v] / expected, 1, 0.03) << v;
    sum += n * expected;
    corners += n;
  }
  EXPECT_NEAR(*solution->calibration.held_out_rms / std::sqrt(sum / corners), 1, 0.01);
}

// The only view has no others that could tell the camera, nor halves that could differ.
TEST(HeldOut, OfTheOnlyViewIsNone) {
  for (int i = 0; i < 20; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const Camera camera = scenes::random_camera("pinhole", random);
    SolveOptions options = plain();
    options.model = "pinhole";
    options.initial = camera.to_calibration();
    options.fix = {"fx", "fy"};
    const auto views = scenes::observe_all(
        camera, kBoard, {scenes::random_pose(camera, kBoard, random, 0.6)}, 0.1, random);
    const auto solution = solve(views, kSize, options);
    ASSERT_TRUE(solution) << solution.error().message;
    EXPECT_FALSE(solution->calibration.held_out_rms) << *solution->calibration.held_out_rms;
    ASSERT_EQ(solution->held_out.size(), 1u);
    EXPECT_TRUE(std::isinf(solution->held_out[0]));
    EXPECT_EQ(solution->misfit.split_half_ratio, 1);
  }
}

// Corners by which a view is told the better weigh the more.
TEST(HeldOut, IsTheMeanByWeight) {
  Random random(42);
  const Camera camera = scenes::random_camera("brown4", random);
  auto views = views_of(camera, 12, random);
  std::normal_distribution<double> noise(0, 1);
  for (View& view : views) {
    for (std::size_t i = 0; i < view.observation.uv.size(); i += 2) {
      view.observation.sigma[i] = 5;
      view.observation.uv[i].u += 0.3 * noise(random);
    }
  }
  const auto solution = solve(views, kSize, plain());
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Observation& seen = views[v].observation;
    double squares = 0;
    double weights = 0;
    const Camera found = Camera::make(solution->calibration).value();
    const SE3 pose = to_se3(solution->calibration.views[v].camera_from_board);
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto at =
          found.project(pose * kBoard.points()[static_cast<std::size_t>(seen.ids[i])]).value();
      const double w = 1 / (seen.sigma[i] * seen.sigma[i]);
      squares += w * (std::pow(at.u - seen.uv[i].u, 2) + std::pow(at.v - seen.uv[i].v, 2));
      weights += w;
    }
    const auto n = static_cast<double>(seen.ids.size());
    const double inside = squares / weights * n / (n - 3);
    // Never better than where the view took part, and not much worse among twelve.
    EXPECT_GT(solution->held_out[v] / inside, 1) << v;
    EXPECT_LT(solution->held_out[v] / inside, 2) << v;
  }
}

// A fit that has another optimum of nearly its cost: the truth may be near either.
TEST(Rivals, AddTheirDistanceByTheirLikelihood) {
  Random random(45);
  const Camera camera = scenes::random_camera("pinhole", random);
  SolveOptions options = plain();
  options.model = "pinhole";
  options.checks = false;
  const Parameterization parameterization = make_parameterization(options, kSize).value();
  const BoardShape flat;
  std::vector<PointSet> sets;
  for (const View& view : scenes::observe_all(
           camera, kBoard, scenes::random_poses(camera, kBoard, random, 8), kNoise, random)) {
    sets.push_back(to_points(kBoard, kBoard.points(), view.observation));
  }
  const WeightScale scale = normalise_weights(sets);
  Fit fit = fit_camera(sets, flat, kSize, parameterization, options, {});
  ASSERT_TRUE(fit.converged);
  const auto covariance_with = [&](double more) {
    fit.rivals.clear();
    if (more > 0) {
      Rival rival = {fit.shared, fit.cost + more * kNoise * kNoise};
      rival.shared[0] += 4;
      rival.shared[2] -= 3;
      fit.rivals.push_back(rival);
    }
    return make_solution({fit, parameterization, flat, scale, 1}, kSize, options, {})
        .value()
        .calibration;
  };
  const Calibration alone = covariance_with(0);
  const double left = std::pow(*alone.find("fx")->sigma, 2);
  // The likelihood of a cost of 2 more is 1/e where a corner's variance is 1.
  const double unit = std::max(1.0, fit.cost / (kNoise * kNoise) / (8 * (2 * 54 - 6) - 4));
  const double likelihood = std::exp(-1 / unit);
  const double part = likelihood / (1 + likelihood);
  const Calibration both = covariance_with(2);
  EXPECT_NEAR(std::pow(*both.find("fx")->sigma, 2) - left, part * 16, 1e-6);
  EXPECT_NEAR(both.covariance[2] - alone.covariance[2], part * -12, 1e-6);
  EXPECT_NEAR(*both.find("fy")->sigma, *alone.find("fy")->sigma, 1e-12);
  // One in fifty, and less.
  EXPECT_GT(*covariance_with(7.5).find("fx")->sigma, *alone.find("fx")->sigma * 1.01);
  EXPECT_EQ(*covariance_with(9).find("fx")->sigma, *alone.find("fx")->sigma);
}

// The hull of what took part: of neither the corner that was left out nor the view that was.
TEST(Covered, IsTheHullOfTheCornersUsed) {
  Random random(46);
  const Camera camera = Camera::make("pinhole", kSize, {1000, 1000, 640, 480}).value();
  const auto board_at = [&](double x, double y, double tilt, double side) {
    const Eigen::Matrix3d turn = exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0});
    const Eigen::Vector3d middle(0.1, 0.0625, 0);
    return scenes::observe(camera, kBoard, {turn, Eigen::Vector3d(x, y, 0.5) - turn * middle},
                           kNoise, random);
  };
  std::vector<View> views;
  for (int i = 0; i < 8; ++i) views.push_back(board_at(0.04 * (i % 3 - 1), 0, 0.5, i));
  SolveOptions options = plain();
  options.model = "pinhole";
  options.reject_outliers = true;
  const auto few = solve(views, kSize, options);
  ASSERT_TRUE(few.has_value()) << few.error().message;
  // A corner that is gross, and a view that is.
  View wrong = board_at(0.15, 0.1, 0.3, 1);
  for (std::size_t i = 0; i < wrong.observation.uv.size(); ++i) {
    wrong.observation.uv[i].u = std::min(wrong.observation.uv[i].u + (i % 2 == 0 ? 60 : 0), 1279.0);
  }
  views.push_back(wrong);
  views[0].observation.uv[0] = {5, 5};
  // Views are named by their place among those given, those without a board too.
  View none = views[0];
  none.observation.ids.clear();
  none.observation.uv.clear();
  none.observation.sigma.clear();
  views.insert(views.begin(), none);
  const auto solution = solve(views, kSize, options);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  ASSERT_EQ(solution->rejected.size(), 2U);
  EXPECT_EQ(solution->rejected[0].index, 0U);
  EXPECT_EQ(solution->rejected[0].reason, Reason::kNotFound);
  EXPECT_EQ(solution->rejected[1].index, 9U);
  EXPECT_EQ(solution->rejected[1].reason, Reason::kOutlier);
  ASSERT_EQ(solution->rejected_corners.size(), 1U);
  EXPECT_EQ(solution->rejected_corners[0].view, 1U);
  EXPECT_EQ(solution->rejected_corners[0].id, 0);
  double left = HUGE_VAL;
  double right = 0;
  double top = HUGE_VAL;
  double bottom = 0;
  for (std::size_t v = 1; v < 9; ++v) {
    for (std::size_t i = v == 1 ? 1 : 0; i < 54; ++i) {
      const Pixel& p = views[v].observation.uv[i];
      left = std::min(left, p.u);
      right = std::max(right, p.u);
      top = std::min(top, p.v);
      bottom = std::max(bottom, p.v);
    }
  }
  double hull[4] = {HUGE_VAL, 0, HUGE_VAL, 0};
  for (const Pixel& p : solution->calibration.covered) {
    hull[0] = std::min(hull[0], p.u);
    hull[1] = std::max(hull[1], p.u);
    hull[2] = std::min(hull[2], p.v);
    hull[3] = std::max(hull[3], p.v);
  }
  EXPECT_EQ(hull[0], left);
  EXPECT_EQ(hull[1], right);
  EXPECT_EQ(hull[2], top);
  EXPECT_EQ(hull[3], bottom);
}

}  // namespace
}  // namespace calvin
