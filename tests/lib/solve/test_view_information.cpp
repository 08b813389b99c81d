// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The information of views against differences of projections, the choice of views against all
// choices, and what the chosen views give against views that were not chosen.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/LU>

#include "calvin/solve/difference.hpp"
#include "calvin/solve/view_information.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

constexpr double kNoise = 0.1;  // px

// Another camera and pose by 1e-6 of a parameter's size along one unknown: parameters, then pose.
Eigen::VectorXd projections(const Camera& camera, const SE3& pose, const Board& board, int unknown,
                            double step) {
  std::vector<double> parameters = camera.parameters();
  const int count = static_cast<int>(parameters.size());
  Eigen::Matrix<double, 6, 1> d = Eigen::Matrix<double, 6, 1>::Zero();
  if (unknown < count) {
    parameters[static_cast<std::size_t>(unknown)] += step;
  } else {
    d[unknown - count] = step;
  }
  const Camera moved = Camera::make(camera.model(), camera.image_size(), parameters).value();
  const Eigen::Matrix3d turn = exp_so3(d.head<3>());
  Eigen::VectorXd all(2 * static_cast<Eigen::Index>(board.points().size()));
  Eigen::Index i = 0;
  for (const Eigen::Vector3d& point : board.points()) {
    const Pixel at = moved.project(turn * (pose * point) + d.tail<3>()).value();
    all[i++] = at.u;
    all[i++] = at.v;
  }
  return all;
}

// The Schur complement of the pose, by differences of projections.
Eigen::MatrixXd information_by_differences(const Camera& camera, const SE3& pose,
                                           const Board& board) {
  const int count = static_cast<int>(camera.parameters().size());
  Eigen::MatrixXd j(2 * static_cast<Eigen::Index>(board.points().size()), count + 6);
  for (int k = 0; k < count + 6; ++k) {
    const double size =
        k < count ? std::max(1.0, camera.parameters()[static_cast<std::size_t>(k)]) : 1;
    const double step = 1e-5 * size;
    j.col(k) =
        (projections(camera, pose, board, k, step) - projections(camera, pose, board, k, -step)) /
        (2 * step);
  }
  const Eigen::MatrixXd n = j.transpose() * j / (kNoise * kNoise);
  return n.topLeftCorner(count, count) - n.topRightCorner(count, 6) *
                                             n.bottomRightCorner(6, 6).inverse() *
                                             n.bottomLeftCorner(6, count);
}

TEST(ViewInformation, IsTheSchurComplementOfThePose) {
  for (const std::string_view model : scenes::kSolvedModels) {
    scenes::Random random(7);
    const Camera camera = scenes::random_camera(model, random);
    const ViewScorer scorer = ViewScorer::make(camera, {}).value();
    for (int i = 0; i < 5; ++i) {
      const SE3 pose = scenes::random_pose(camera, scenes::kBoard, random, 0.6);
      const View view = scenes::observe(camera, scenes::kBoard, pose, kNoise, random);
      const Eigen::MatrixXd found = scorer.information(view, pose).value();
      const Eigen::MatrixXd expected = information_by_differences(camera, pose, scenes::kBoard);
      const Eigen::VectorXd scale = expected.diagonal().array().sqrt().inverse();
      EXPECT_LT((scale.asDiagonal() * (found - expected) * scale.asDiagonal()).norm(), 1e-5)
          << model << ", pose " << i;
    }
  }
}

// The variance of projections when one parameter is known but for `sigma`, and all others exactly.
double variance_of_one(const ViewScorer& scorer, Eigen::Index parameter, double sigma) {
  Eigen::VectorXd known = 1e20 * scorer.prior().diagonal();
  known[parameter] = 1 / (sigma * sigma);
  return scorer.variance(known.asDiagonal());
}

// Half of the mean squared change of projections when that parameter is another by `step`.
double change_by_one(const Camera& camera, std::size_t parameter, double step) {
  std::vector<double> parameters = camera.parameters();
  parameters[parameter] += step;
  const Camera moved = Camera::make(camera.model(), camera.image_size(), parameters).value();
  const double rms = difference(camera, moved).value().image.rms;
  return rms * rms / 2;
}

// A grid of 65x49 pixels is held against one of far fewer, whose outermost weigh more.
TEST(ViewInformation, TheVarianceIsThatOfTheProjections) {
  for (const std::string_view model : {"pinhole", "brown4", "fisheye"}) {
    scenes::Random random(11);
    const Camera camera = scenes::random_camera(model, random);
    const ViewScorer scorer = ViewScorer::make(camera, {}).value();
    for (std::size_t i = 0; i < camera.parameters().size(); ++i) {
      const double step = 1e-4 * std::max(1.0, camera.parameters()[i]);
      const double found = variance_of_one(scorer, static_cast<Eigen::Index>(i), step);
      const double expected = change_by_one(camera, i, step);
      EXPECT_GT(found, 0.9 * expected) << model << ", parameter " << i;
      EXPECT_LT(found, 1.4 * expected) << model << ", parameter " << i;
    }
  }
}

TEST(ViewInformation, VariancesAddAsCovariancesDo) {
  scenes::Random random(12);
  const Camera camera = scenes::random_camera("brown5", random);
  const ViewScorer scorer = ViewScorer::make(camera, {}).value();
  std::vector<Eigen::MatrixXd> covariances;
  Eigen::MatrixXd known = scorer.prior();
  for (int i = 0; i < 2; ++i) {
    const SE3 pose = scenes::random_pose(camera, scenes::kBoard, random, 0.6);
    const View view = scenes::observe(camera, scenes::kBoard, pose, kNoise, random);
    known += scorer.information(view, pose).value();
    covariances.push_back(known.inverse());
  }
  const Eigen::MatrixXd both = covariances[0] + covariances[1];
  const double expected =
      scorer.variance(covariances[0].inverse()) + scorer.variance(covariances[1].inverse());
  EXPECT_NEAR(scorer.variance(both.inverse()), expected, 1e-6 * expected);
}

TEST(ViewInformation, WhatLeavesADirectionOpenHasNoVariance) {
  scenes::Random random(13);
  const Camera camera = scenes::random_camera("brown5", random);
  const ViewScorer scorer = ViewScorer::make(camera, {}).value();
  Eigen::MatrixXd known = scorer.prior();
  known(0, 0) = 0;
  EXPECT_EQ(scorer.variance(known), HUGE_VAL);
  known(0, 0) = std::nan("");
  EXPECT_EQ(scorer.variance(known), HUGE_VAL);
}

TEST(ViewInformation, HoldsWhatTheOptionsHold) {
  scenes::Random random(3);
  const Camera camera = scenes::random_camera("brown5", random);
  SolveOptions options;
  EXPECT_EQ(ViewScorer::make(camera, options).value().prior().rows(), 9);
  options.fix = {"k3", "center"};
  EXPECT_EQ(ViewScorer::make(camera, options).value().prior().rows(), 6);
  options.skew = true;
  EXPECT_EQ(ViewScorer::make(camera, options).value().prior().rows(), 7);
  options.fix = {"k9"};
  EXPECT_FALSE(ViewScorer::make(camera, options).has_value());
}

TEST(ViewInformation, ABrokenViewHasNone) {
  scenes::Random random(3);
  const Camera camera = scenes::random_camera("brown5", random);
  const ViewScorer scorer = ViewScorer::make(camera, {}).value();
  const SE3 pose = scenes::random_pose(camera, scenes::kBoard, random, 0.6);
  View view = scenes::observe(camera, scenes::kBoard, pose, kNoise, random);
  SE3 behind = pose;
  behind.translation.z() = -behind.translation.z();
  EXPECT_FALSE(scorer.information(view, behind).has_value());
  view.observation.uv.front().u = NAN;
  EXPECT_FALSE(scorer.information(view, pose).has_value());
  view.observation = {};
  EXPECT_FALSE(scorer.information(view, pose).has_value());
}

struct Pool {
  std::vector<SE3> poses;
  std::vector<Eigen::MatrixXd> information;
};

// Boards tilted 0 to 45 degrees that fill half of the picture's width and more.
Pool pool_of(const ViewScorer& scorer, const Camera& camera, int count, scenes::Random& random) {
  Pool pool;
  const double far = camera.fx() * scenes::kBoard.extent().width() / (0.5 * scenes::kSize.width);
  while (static_cast<int>(pool.poses.size()) < count) {
    const SE3 pose = scenes::random_poses(camera, scenes::kBoard, random, 1).front();
    const BoardArea area = scenes::kBoard.extent();
    const Eigen::Vector3d center((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
    if ((pose * center).norm() <= far) pool.poses.push_back(pose);
  }
  for (const SE3& pose : pool.poses) {
    const View view = scenes::observe(camera, scenes::kBoard, pose, kNoise, random);
    pool.information.push_back(scorer.information(view, pose).value());
  }
  return pool;
}

double variance_of(const ViewScorer& scorer, const Pool& pool,
                   const std::vector<std::size_t>& views) {
  Eigen::MatrixXd sum = scorer.prior();
  for (const std::size_t i : views) sum += pool.information[i];
  return scorer.variance(sum);
}

TEST(MostInformative, IsNearTheBestOfAllChoices) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    scenes::Random random(seed);
    const Camera camera = scenes::random_camera("brown5", random);
    const ViewScorer scorer = ViewScorer::make(camera, {}).value();
    const Pool pool = pool_of(scorer, camera, 12, random);
    const auto variance = [&](const std::vector<std::size_t>& views) {
      return variance_of(scorer, pool, views);
    };
    double best = HUGE_VAL;
    for (std::size_t a = 0; a < 12; ++a) {
      for (std::size_t b = a + 1; b < 12; ++b) {
        for (std::size_t c = b + 1; c < 12; ++c) {
          for (std::size_t d = c + 1; d < 12; ++d) best = std::min(best, variance({a, b, c, d}));
        }
      }
    }
    const auto chosen = most_informative(scorer, pool.information, 4);
    ASSERT_EQ(chosen.size(), 4U);
    EXPECT_LT(variance(chosen), 1.25 * best) << "seed " << seed;
  }
}

// Where an exchange ends: no view that was left is worth more than one that was taken.
TEST(MostInformative, IsLeftByNoExchangeForABetterOne) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    scenes::Random random(seed);
    const Camera camera = scenes::random_camera("brown5", random);
    const ViewScorer scorer = ViewScorer::make(camera, {}).value();
    const Pool pool = pool_of(scorer, camera, 40, random);
    const auto chosen = most_informative(scorer, pool.information, 6);
    const double taken = variance_of(scorer, pool, chosen);
    for (std::size_t place = 0; place < chosen.size(); ++place) {
      for (std::size_t other = 0; other < pool.information.size(); ++other) {
        if (std::ranges::count(chosen, other) > 0) continue;
        auto exchanged = chosen;
        exchanged[place] = other;
        EXPECT_GT(variance_of(scorer, pool, exchanged), taken * (1 - 1e-6))
            << "seed " << seed << ": " << other << " for " << chosen[place];
      }
    }
  }
}

TEST(MostInformative, TakesAllWhereThereAreNoMore) {
  scenes::Random random(1);
  const Camera camera = scenes::random_camera("brown5", random);
  const ViewScorer scorer = ViewScorer::make(camera, {}).value();
  const Pool pool = pool_of(scorer, camera, 3, random);
  EXPECT_EQ(most_informative(scorer, pool.information, 5), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(most_informative(scorer, pool.information, 0).empty());
  EXPECT_TRUE(most_informative(scorer, {}, 3).empty());
}

// The spread of fx over solves of the same poses with other noise.
double spread_of_fx(const Camera& camera, const std::vector<SE3>& poses, int solves,
                    scenes::Random& random) {
  SolveOptions options;
  options.checks = false;
  options.warp = false;
  std::vector<double> fx;
  for (int i = 0; i < solves; ++i) {
    const auto views = scenes::observe_all(camera, scenes::kBoard, poses, kNoise, random);
    fx.push_back(
        solve(views, camera.image_size(), options).value().calibration.parameters[0].value);
  }
  const double mean = std::accumulate(fx.begin(), fx.end(), 0.0) / solves;
  double square = 0;
  for (const double x : fx) square += (x - mean) * (x - mean);
  return std::sqrt(square / (solves - 1));
}

TEST(MostInformative, TwentyFiveOf250AreWorthMoreThanRandomOnes) {
  constexpr std::size_t kViews = 25;
  const int solves = scenes::full_count() ? 1000 : 150;
  scenes::Random random(5);
  const Camera camera = scenes::random_camera("brown5", random);
  const ViewScorer scorer = ViewScorer::make(camera, {}).value();
  const Pool pool = pool_of(scorer, camera, 250, random);
  std::vector<SE3> chosen;
  for (const std::size_t i : most_informative(scorer, pool.information, kViews)) {
    chosen.push_back(pool.poses[i]);
  }
  const double with_choice = spread_of_fx(camera, chosen, solves, random);
  double without = 0;  // the mean variance of some random choices
  constexpr int kChoices = 5;
  for (int i = 0; i < kChoices; ++i) {
    std::vector<SE3> any = pool.poses;
    std::shuffle(any.begin(), any.end(), random);
    any.resize(kViews);
    const double spread = spread_of_fx(camera, any, solves / kChoices, random);
    without += spread * spread / kChoices;
  }
  RecordProperty("ratio", std::to_string(with_choice / std::sqrt(without)));
  EXPECT_LT(with_choice, 0.65 * std::sqrt(without));
}

}  // namespace
}  // namespace calvin
