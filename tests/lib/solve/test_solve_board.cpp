// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards that are not as they were meant: the solve that is asked to finds how.
#include <cmath>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/residuals/board_shape.hpp"
#include "inked_board.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;
using scenes::random_offsets;
using scenes::views_of;

void expect_camera(const Calibration& found, const Camera& truth) {
  for (std::size_t i = 0; i < truth.parameters().size(); ++i) {
    const Parameter& p = found.parameters[i];
    EXPECT_NEAR((p.value - truth.parameters()[i]) / *p.sigma, 0, 4) << p.name;
  }
}

// z = kx (1 - x^2) + ky (1 - y^2), x and y in -1..1 over the board.
TEST(BoardShape, BendsAreThoseOfTheFile) {
  const auto points = bent_points(kBoard, {3e-3, -5e-3});
  const auto printed = kBoard.points();
  ASSERT_EQ(points.size(), printed.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = static_cast<double>(i % 9) / 4 - 1;
    const double y = static_cast<double>(i / 9) / 2.5 - 1;
    const Eigen::Vector3d bend(0, 0, 3e-3 * (1 - x * x) - 5e-3 * (1 - y * y));
    EXPECT_LT((points[i] - printed[i] - bend).norm(), 1e-12) << i;
  }
}

TEST(BoardShape, AspectIsFoundWithinItsSigma) {
  const int trials = scenes::full_count() ? 100 : 5;
  double squares = 0;
  for (int i = 0; i < trials; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const Camera camera = scenes::random_camera("brown5", random);
    auto points = kBoard.points();
    for (Eigen::Vector3d& p : points) p.y() *= 1.002;
    SolveOptions options;
    options.aspect = true;
    const auto solution = solve(views_of(camera, points, 15, random), kSize, options);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    ASSERT_TRUE(solution->board_aspect.has_value());
    EXPECT_LT(solution->board_aspect->sigma, 2e-4);
    const double off = (solution->board_aspect->value - 1.002) / solution->board_aspect->sigma;
    EXPECT_LT(std::abs(off), 4) << i;
    squares += off * off;
    expect_camera(solution->calibration, camera);
  }
  EXPECT_NEAR(squares / trials, 1, 4 * std::sqrt(2.0 / trials));
}

TEST(BoardShape, OffsetsOfSingleCornersAreFound) {
  const int trials = scenes::full_count() ? 20 : 1;
  double normalised = 0;
  for (int i = 0; i < trials; ++i) {
    Random random(static_cast<std::uint64_t>(100 + i));
    const Camera camera = scenes::random_camera("brown5", random);
    const auto printed = kBoard.points();
    auto points = printed;
    const Eigen::MatrixX3d truth = random_offsets(1e-4, random);
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k] += truth.row(static_cast<Eigen::Index>(k)).transpose();
    }
    const auto views = views_of(camera, points, 25, random);
    SolveOptions options;
    options.reject_outliers = false;
    const auto flat = solve(views, kSize, options);
    ASSERT_TRUE(flat.has_value()) << flat.error().message;
    EXPECT_EQ(flat->misfit.noticed, Misfit::Cause::kBoard);
    EXPECT_TRUE(flat->corner_offsets.empty());

    options.offsets = true;
    const auto solution = solve(views, kSize, options);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    EXPECT_NEAR(*solution->calibration.chi, 1, 0.1);
    EXPECT_FALSE(solution->misfit.found()) << to_string(solution->misfit.cause);
    expect_camera(solution->calibration, camera);
    ASSERT_EQ(solution->corner_offsets.size(), printed.size());
    for (std::size_t k = 0; k < printed.size(); ++k) {
      const CornerOffset& found = solution->corner_offsets[k];
      const Eigen::Vector3d off = found.value - truth.row(static_cast<Eigen::Index>(k)).transpose();
      EXPECT_LT(found.sigma.maxCoeff(), 0.5e-4);
      normalised += off.cwiseQuotient(found.sigma).squaredNorm() / (3.0 * 54 * trials);
    }
  }
  EXPECT_NEAR(normalised, 1, scenes::full_count() ? 0.1 : 0.4);
}

TEST(BoardShape, TakesManyViewsOfOneBoard) {
  Random random(3);
  const Camera camera = scenes::random_camera("brown5", random);
  SolveOptions options;
  options.aspect = options.offsets = true;
  const auto few = solve(views_of(camera, kBoard.points(), 7, random), kSize, options);
  ASSERT_TRUE(few.has_value()) << few.error().message;
  EXPECT_FALSE(few->board_aspect.has_value());
  EXPECT_TRUE(few->corner_offsets.empty());
}

// Corners that are not where they were printed are the same in every view: however many views agree
// on a camera, what they share stays a part of its covariance.
TEST(BoardOffsets, AreAPartOfTheCovarianceOfAnyNumberOfViews) {
  const int trials = scenes::full_count() ? 60 : 12;
  double squares = 0;
  for (int i = 0; i < trials; ++i) {
    Random random(static_cast<std::uint64_t>(700 + i));
    auto points = kBoard.points();
    const Eigen::MatrixX3d offsets = random_offsets(2e-4, random);
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k] += offsets.row(static_cast<Eigen::Index>(k)).transpose();
    }
    const Camera camera = scenes::random_camera("brown5", random);
    const auto solution = solve(views_of(camera, points, 100, random), kSize, {});
    ASSERT_TRUE(solution) << solution.error().message;
    squares += scenes::normalised_error(solution->calibration, camera);
  }
  std::cout << "  normalised error " << squares / trials << "\n";
  // The covariance holds shears and scales of the board too, which these sheets lack: .4 of it.
  EXPECT_GT(squares / trials, 0.2);
  EXPECT_LT(squares / trials, 1.6);
}

}  // namespace
}  // namespace calvin
