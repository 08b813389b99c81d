// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is kept of a measured board: a covariance by few numbers, and marks of views.
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "calvin/target/kinds.hpp"
#include "calvin/target/measured/board_fields.hpp"
#include "calvin/target/measured/board_measurement.hpp"

namespace calvin {
namespace {

const Board kBoard = Checkerboard{9, 6, 0.025};

TEST(BoardMeasurement, UnmeasuredOffsetsAreNoShiftTurnScaleShearOrTilt) {
  const BoardMeasurement board = unmeasured(kBoard).value();
  const auto points = kBoard.points();
  ASSERT_EQ(board.covariance.rows(), 3 * 54);
  Eigen::MatrixXd moves(3 * 54, 9);
  for (Eigen::Index i = 0; i < 54; ++i) {
    const Eigen::Vector3d& p = points[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < 3; ++k) {
      moves.block<1, 9>(3 * i + k, 0).setZero();
      moves.block<1, 3>(3 * i + k, 3 * k) << 1, p.x(), p.y();
    }
  }
  EXPECT_LT((board.covariance * moves).cwiseAbs().maxCoeff(), 1e-15);
  // All others are free.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(board.covariance);
  EXPECT_EQ((eigen.eigenvalues().array() > 1e-7).count(), 3 * 54 - 9);
}

TEST(BoardMeasurement, BoardsWithoutAShapeAreRefused) {
  EXPECT_FALSE(unmeasured(Checkerboard{9, 2, 0.025}));
  EXPECT_FALSE(unmeasured(Checkerboard{100, 100, 0.025}));
}

TEST(BoardMeasurement, FewNumbersKeepVariancesAndWhatManyHaveInCommon) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  const auto draw = [&](Eigen::Index, Eigen::Index) { return normal(random); };
  const Eigen::MatrixXd modes = Eigen::MatrixXd::NullaryExpr(60, 4, draw);
  Eigen::MatrixXd covariance = modes * modes.transpose();
  covariance.diagonal() += Eigen::VectorXd::LinSpaced(60, 0.5, 2);
  const Eigen::MatrixXd kept = compact(covariance, 4).full();
  EXPECT_LT((kept.diagonal() - covariance.diagonal()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((kept - covariance).norm(), 0.05 * covariance.norm());
  const CompactCovariance few = compact(covariance, 1);
  EXPECT_LT((few.full().diagonal() - covariance.diagonal()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GT(few.own.minCoeff(), 0);
}

TEST(BoardMeasurement, AViewIsKnownAgainAndAnotherOneIsNot) {
  Observation seen;
  for (int i = 0; i < 20; ++i) seen.uv.push_back({10.0 * i, 300.0 - 7 * i});
  Observation again = seen;
  for (Pixel& p : again.uv) p.u += 0.01;
  EXPECT_TRUE(same_view(mark_of(seen), mark_of(again)));
  Observation moved = seen;
  for (Pixel& p : moved.uv) p.v += 1;
  EXPECT_FALSE(same_view(mark_of(seen), mark_of(moved)));
  Observation larger = seen;
  for (Pixel& p : larger.uv) p.u = 95 + 1.01 * (p.u - 95);
  EXPECT_FALSE(same_view(mark_of(seen), mark_of(larger)));
}

}  // namespace
}  // namespace calvin
