// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards that were measured before: cameras are the better for them, their promise stays true, and
// a board that is no longer the one that was measured is noticed.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/target/measured/board_measurement.hpp"
#include "halves.hpp"
#include "inked_board.hpp"
#include "real_sets.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Apart;
using scenes::kBoard;
using scenes::kSize;
using scenes::Random;
using Measured = std::shared_ptr<const BoardMeasurement>;

// A sheet whose corners are off by .1 mm each, 1 sigma along each axis, and that is bent.
std::vector<Eigen::Vector3d> sheet(Random& random, const BoardWarp& warp = {}) {
  constexpr double kInk = 1e-4;
  auto points = bent_points(kBoard, warp);
  const Eigen::MatrixX3d offsets = scenes::random_offsets(kInk, random);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] += offsets.row(static_cast<Eigen::Index>(i)).transpose();
  }
  return points;
}

std::vector<View> seen(const std::vector<Eigen::Vector3d>& points, int count, Random& random) {
  return scenes::views_of(scenes::random_camera("brown5", random), points, count, random);
}

Measured measure(const std::vector<View>& views, ImageSize size, const SolveOptions& lens) {
  SolveOptions options = lens;
  options.offsets = true;
  const auto solution = solve(views, size, options);
  return solution ? solution->measured : nullptr;
}

SolveOptions knowing(Measured measured, const SolveOptions& lens = {}) {
  SolveOptions options = lens;
  options.measured = std::move(measured);
  return options;
}

// The logarithm of the geometric mean of the ratios.
double mean_log_ratio(const Apart& with, const Apart& without) {
  double sum = 0;
  for (std::size_t i = 0; i < with.pixels.size(); ++i) {
    sum += std::log(with.pixels[i] / without.pixels[i]);
  }
  return sum / static_cast<double>(with.pixels.size());
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool says(const Calibration& calibration, const char* words) {
  return std::any_of(calibration.remarks.begin(), calibration.remarks.end(),
                     [words](const std::string& r) { return r.find(words) != std::string::npos; });
}

// Halves of what one camera saw, the board known from what the other one saw and not. The limits of
// honesty are those of the halves without a measured board, in test_solve_real.cpp.
TEST(MeasuredBoard, HalvesOfRealSetsAreNearerToEachOther) {
  const int count = scenes::full_count() ? 40 : 10;
  double sum = 0;
  int directions = 0;
  for (const auto& [first, second] :
       {std::pair("left", "right"), std::pair("stereo_left", "stereo_right")}) {
    std::vector<const real::Set*> sets;
    std::vector<real::Views> views;
    for (const real::Set& set : real::kSets) {
      if (std::string(set.name) != first && std::string(set.name) != second) continue;
      sets.push_back(&set);
      views.push_back(real::read(set));
    }
    if (views[0].views.empty() || views[1].views.empty()) {
      GTEST_SKIP() << "CALVIN_DATA does not name a folder with " << sets[1]->folder;
    }
    SolveOptions lens;
    lens.model = sets[0]->model;
    for (const std::size_t i : {0U, 1U}) {
      const Measured board = measure(views[1 - i].views, views[1 - i].size, lens);
      ASSERT_TRUE(board) << sets[1 - i]->name;
      const Apart without = scenes::halves(views[i].views, views[i].size, lens, count);
      const Apart with = scenes::halves(views[i].views, views[i].size, knowing(board, lens), count);
      ASSERT_EQ(with.pixels.size(), without.pixels.size()) << sets[i]->name;
      const double middle = median(with.projections);
      const auto beyond = std::count_if(with.projections.begin(), with.projections.end(),
                                        [](double x) { return x > 2; });
      std::cout << "  " << sets[i]->name << ": " << std::exp(mean_log_ratio(with, without))
                << " of the difference, median " << middle << ", beyond 2 in " << beyond << "\n";
      const double luck = scenes::full_count() ? 1 : 1.4;
      EXPECT_GE(middle, 0.3 / luck) << sets[i]->name;
      EXPECT_LE(middle, 1.6 * luck) << sets[i]->name;
      EXPECT_LE(static_cast<double>(beyond), 0.3 * luck * count) << sets[i]->name;
      sum += mean_log_ratio(with, without);
      ++directions;
    }
  }
  std::cout << "  all: " << std::exp(sum / directions) << "\n";
  EXPECT_LE(std::exp(sum / directions), 0.9);
}

TEST(MeasuredBoard, HalvesOfRenderedViewsAreTwiceAsNear) {
  const int pairs = scenes::full_count() ? 50 : 8;
  double sum = 0;
  std::vector<double> apart;
  for (int i = 0; i < pairs; ++i) {
    Random random(static_cast<std::uint64_t>(200 + i));
    const auto points = sheet(random);
    const Measured board = measure(seen(points, 25, random), kSize, {});
    ASSERT_TRUE(board) << i;
    const auto views = seen(points, 24, random);
    const Apart without = scenes::halves(views, kSize, {}, 4);
    const Apart with = scenes::halves(views, kSize, knowing(board), 4);
    ASSERT_EQ(with.pixels.size(), without.pixels.size()) << i;
    sum += mean_log_ratio(with, without);
    apart.insert(apart.end(), with.projections.begin(), with.projections.end());
  }
  std::cout << "  " << std::exp(sum / pairs) << " of the difference, median " << median(apart)
            << "\n";
  EXPECT_LE(std::exp(sum / pairs), 0.5);
  EXPECT_GE(median(apart), 0.3);
  EXPECT_LE(median(apart), 1.6);
}

// What is left unknown of the board is a part of the covariance, once; of many views it is most of
// it.
TEST(MeasuredBoard, TheCovarianceHoldsWhatIsLeftUnknownOfIt) {
  const int trials = scenes::full_count() ? 100 : 15;
  for (const int count : {25, 300}) {
    double squares = 0;
    for (int i = 0; i < trials; ++i) {
      Random random(static_cast<std::uint64_t>(400 + i));
      const auto points = sheet(random);
      const Measured board = measure(seen(points, 12, random), kSize, {});
      ASSERT_TRUE(board) << i;
      const Camera camera = scenes::random_camera("brown5", random);
      const auto solution =
          solve(scenes::views_of(camera, points, count, random), kSize, knowing(board));
      ASSERT_TRUE(solution) << solution.error().message;
      squares += scenes::normalised_error(solution->calibration, camera);
    }
    std::cout << "  " << count << " views: " << squares / trials << "\n";
    // Nine parameters in each trial, whose errors have a few directions in common with the board.
    EXPECT_GT(squares / trials, 0.6) << count;
    EXPECT_LT(squares / trials, 1.6) << count;
  }
}

// The file of a camera tells how its board is bent, whoever found that.
TEST(MeasuredBoard, ItsCurvaturesAreThoseOfTheResult) {
  Random random(8);
  const auto points = sheet(random, {1e-3, -5e-4});
  const Measured board = measure(seen(points, 15, random), kSize, {});
  ASSERT_TRUE(board);
  const auto solution = solve(seen(points, 3, random), kSize, knowing(board));
  ASSERT_TRUE(solution) << solution.error().message;
  ASSERT_TRUE(solution->calibration.warp);
  const BoardWarp& warp = *solution->calibration.warp;
  EXPECT_NEAR((warp.kx - 1e-3) / warp.kx_sigma.value(), 0, 4);
  EXPECT_NEAR((warp.ky + 5e-4) / warp.ky_sigma.value(), 0, 4);
  EXPECT_LT(*warp.kx_sigma, 1e-4);
  EXPECT_EQ(solution->corner_offsets.size(), 54U);
  EXPECT_FALSE(solution->measured);
}

TEST(MeasuredBoard, GetsBetterWithEveryCamera) {
  Random random(5);
  const auto points = sheet(random, {1e-3, -5e-4});
  const Measured first = measure(seen(points, 12, random), kSize, {});
  ASSERT_TRUE(first);
  const Measured second = measure(seen(points, 12, random), kSize, knowing(first));
  ASSERT_TRUE(second);
  EXPECT_EQ(first->views.size(), 12U);
  EXPECT_EQ(second->views.size(), 24U);
  EXPECT_LT(second->covariance.trace(), 0.7 * first->covariance.trace());
  const auto off = [&points](const BoardMeasurement& board) {
    // Of what poses and focal lengths do not explain: the offsets hold nothing else.
    const BoardMeasurement truth = unmeasured(board.board).value();
    double sum = 0;
    const auto printed = board.board.points();
    Eigen::VectorXd difference(3 * static_cast<Eigen::Index>(printed.size()));
    for (std::size_t i = 0; i < printed.size(); ++i) {
      difference.segment<3>(3 * static_cast<Eigen::Index>(i)) =
          points[i] - printed[i] - board.offsets[i];
    }
    // A wide covariance that has none of them turns them to nothing.
    const Eigen::VectorXd left = truth.covariance * difference / truth.covariance.trace();
    sum += left.squaredNorm();
    return sum;
  };
  EXPECT_LT(off(*second), off(*first));
}

TEST(MeasuredBoard, IsNotUsedByTheViewsThatItWasMadeOf) {
  Random random(6);
  const auto views = seen(sheet(random), 15, random);
  const Measured board = measure(views, kSize, {});
  ASSERT_TRUE(board);
  const auto plain = solve(views, kSize);
  const auto again = solve(views, kSize, knowing(board));
  ASSERT_TRUE(plain && again);
  EXPECT_TRUE(says(again->calibration, "count once")) << again->calibration.remarks.size();
  EXPECT_EQ(again->calibration.find("fx")->value, plain->calibration.find("fx")->value);
  EXPECT_EQ(again->calibration.find("fx")->sigma, plain->calibration.find("fx")->sigma);
}

// Turned by half a turn the corners are where others were measured.
TEST(MeasuredBoard, SaysNothingToViewsThatMayBeLabelledOtherwise) {
  Random random(7);
  const auto points = sheet(random);
  const Measured board = measure(seen(points, 15, random), kSize, {});
  ASSERT_TRUE(board);
  auto views = seen(points, 15, random);
  for (View& view : views) view.observation.ambiguous = {{2, 0, 0}};
  EXPECT_FALSE(measure(views, kSize, {}));
  const auto plain = solve(views, kSize);
  const auto known = solve(views, kSize, knowing(board));
  ASSERT_TRUE(plain && known);
  EXPECT_EQ(known->calibration.find("fx")->value, plain->calibration.find("fx")->value);
}

// All that was measured of it are errors, of which the next views say that they are none of its.
TEST(MeasuredBoard, ASheetThatWasPrintedExactlyIsTheSameSheet) {
  int noticed = 0;
  const int sessions = scenes::full_count() ? 50 : 10;
  for (int i = 0; i < sessions; ++i) {
    Random random(static_cast<std::uint64_t>(900 + i));
    const auto points = kBoard.points();
    const Measured first = measure(seen(points, 25, random), kSize, {});
    ASSERT_TRUE(first) << i;
    const auto solution = solve(seen(points, 25, random), kSize, knowing(first));
    ASSERT_TRUE(solution.has_value()) << i;
    noticed += solution->other_board ? 1 : 0;
  }
  EXPECT_LE(noticed, 0.05 * sessions);
}

TEST(MeasuredBoard, AnotherSheetOrABentOneIsNoticed) {
  const int sessions = scenes::full_count() ? 50 : 6;
  int same = 0;
  int printed_anew = 0;
  int bent = 0;
  for (int i = 0; i < sessions; ++i) {
    Random random(static_cast<std::uint64_t>(600 + i));
    const BoardWarp warp = {scenes::uniform(random, -5e-4, 5e-4),
                            scenes::uniform(random, -5e-4, 5e-4)};
    const auto points = sheet(random, warp);
    const Measured board = measure(seen(points, 25, random), kSize, {});
    ASSERT_TRUE(board) << i;
    const auto noticed = [&](const std::vector<Eigen::Vector3d>& shown) {
      const auto solution = solve(seen(shown, 12, random), kSize, knowing(board));
      const bool is = solution && solution->other_board;
      EXPECT_EQ(is, solution && says(solution->calibration, "another sheet")) << i;
      return is ? 1 : 0;
    };
    same += noticed(points);
    printed_anew += noticed(sheet(random, warp));
    auto bent_points_now = points;
    const auto more = bent_points(kBoard, {3e-4, 0});
    for (std::size_t k = 0; k < points.size(); ++k) bent_points_now[k].z() += more[k].z();
    bent += noticed(bent_points_now);
  }
  std::cout << "  noticed: same " << same << ", printed anew " << printed_anew << ", bent " << bent
            << " of " << sessions << "\n";
  EXPECT_LE(same, 0.05 * sessions);
  EXPECT_GE(printed_anew, 0.95 * sessions);
  EXPECT_GE(bent, 0.95 * sessions);
}

}  // namespace
}  // namespace calvin
