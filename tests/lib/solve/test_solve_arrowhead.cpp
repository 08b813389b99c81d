// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The elimination of poses and points against the whole matrix, and residuals that depend on some
// of the shared unknowns only.
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "calvin/solve/linear/arrowhead.hpp"

namespace calvin {
namespace {

constexpr ArrowLayout kLayout = {13, 2, 3};
constexpr int kRows = 24;  // of each residual block

// Some residuals: the small block and the shared unknowns that they depend on.
struct Residuals {
  std::size_t block;
  std::vector<ParameterRange> ranges;
};
const std::vector<Residuals> kResiduals = {
    {0, {{0, 4}, {4, 0}, {9, 3}}},
    {0, {{4, 3}, {7, 2}}},
    {1, {{0, 13}}},
    {1, {{1, 1}, {12, 1}}},
    {2, {{0, 4}}},
    {2, {{4, 3}, {8, 1}}},
    {3, {{11, 2}}},
    {4, {{0, 2}, {3, 2}}},
};

int first_of(std::size_t block) {
  const auto b = static_cast<int>(block);
  return b < 2 ? 6 * b : 12 + 3 * (b - 2);
}
constexpr int kSmall = 6 + 6 + 3 + 3 + 3;
constexpr int kAll = kSmall + 13;

ArrowColumns columns_of(const std::vector<ParameterRange>& r) {
  const auto at = [&r](std::size_t i) { return i < r.size() ? r[i] : ParameterRange(); };
  return {at(0), at(1), at(2)};
}

class Arrowhead : public ::testing::Test {
 protected:
  // Adds all residuals, and makes the whole of their normal equations from the same rows.
  void SetUp() override {
    std::mt19937_64 random(5);
    std::normal_distribution<double> draw(0, 1);
    whole_ = Eigen::MatrixXd::Zero(kAll, kAll);
    gradient_ = Eigen::VectorXd::Zero(kAll);
    equations_.clear();
    for (const Residuals& residuals : kResiduals) {
      std::vector<int> places;  // of the columns in the whole matrix
      const int n = kLayout.size(residuals.block);
      for (int i = 0; i < n; ++i) places.push_back(first_of(residuals.block) + i);
      for (const ParameterRange& range : residuals.ranges) {
        for (int i = 0; i < range.count; ++i) places.push_back(kSmall + range[i]);
      }
      const auto count = static_cast<Eigen::Index>(places.size());
      const Eigen::MatrixXd j =
          Eigen::MatrixXd::NullaryExpr(kRows, count, [&] { return draw(random); });
      const Eigen::VectorXd r = Eigen::VectorXd::NullaryExpr(kRows, [&] { return draw(random); });
      whole_(places, places) += j.transpose() * j;
      gradient_(places) += j.transpose() * r;
      cost_ += r.squaredNorm();
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::MatrixXd rows(kRows, count + 1);
      rows << j.leftCols(n), r, j.rightCols(count - n);
      const RowMajor products = rows.transpose() * rows;
      equations_.add(residuals.block, columns_of(residuals.ranges), products.data(),
                     static_cast<std::size_t>(count) + 1);
    }
  }

  ArrowEquations equations_{kLayout};
  Eigen::MatrixXd whole_;
  Eigen::VectorXd gradient_;
  double cost_ = 0;
};

TEST_F(Arrowhead, LeavesTheSchurComplementOfTheSharedUnknowns) {
  ArrowElimination elimination(kLayout);
  ASSERT_TRUE(elimination.eliminate(equations_, 0));
  const Eigen::MatrixXd d = whole_.topLeftCorner(kSmall, kSmall);
  const Eigen::MatrixXd e = whole_.topRightCorner(kSmall, 13);
  const Eigen::MatrixXd by_d = d.inverse() * e;
  const Eigen::MatrixXd schur = whole_.bottomRightCorner(13, 13) - e.transpose() * by_d;
  EXPECT_LT((elimination.schur() - schur).norm(), 1e-10 * schur.norm());
  const Eigen::VectorXd reduced = gradient_.tail(13) - by_d.transpose() * gradient_.head(kSmall);
  EXPECT_LT((elimination.reduced_gradient() - reduced).norm(), 1e-10 * reduced.norm());
  const Eigen::VectorXd head = gradient_.head(kSmall);
  EXPECT_NEAR(elimination.reduced_cost(), cost_ - head.dot(d.inverse() * head), 1e-9 * cost_);
}

TEST_F(Arrowhead, StepsAsTheWholeMatrixDoes) {
  constexpr double kLambda = 0.25;
  Eigen::MatrixXd damped = whole_;
  damped.diagonal().head(kSmall) *= 1 + kLambda;
  const Eigen::VectorXd step = -damped.partialPivLu().solve(gradient_);
  ArrowElimination elimination(kLayout);
  ASSERT_TRUE(elimination.eliminate(equations_, kLambda));
  const Eigen::VectorXd shared =
      -elimination.schur().partialPivLu().solve(elimination.reduced_gradient());
  EXPECT_LT((shared - step.tail(13)).norm(), 1e-9 * step.norm());
  for (std::size_t block = 0; block < kLayout.blocks(); ++block) {
    double small[6];
    elimination.block_step(block, shared, small);
    for (int i = 0; i < kLayout.size(block); ++i) {
      EXPECT_NEAR(small[i], step[first_of(block) + i], 1e-9 * step.norm()) << block;
    }
  }
}

// Whatever a residual does not depend on stays exactly as it is.
TEST_F(Arrowhead, TouchesTheColumnsThatAreNamedAlone) {
  ArrowEquations equations(kLayout);
  equations.clear();
  const std::vector<double> products(36, 1.0);
  equations.add(3, {{2, 1}, {10, 1}}, products.data(), 6);
  for (int i = 0; i < 13; ++i) {
    EXPECT_EQ(equations.shared_gradient(i), i == 2 || i == 10 ? 1 : 0) << i;
    EXPECT_EQ(equations.cross(3)[i + 1], i == 2 || i == 10 ? 1 : 0) << i;
    for (int j = 0; j <= i; ++j) {
      EXPECT_EQ(equations.shared(i, j), (i == 2 || i == 10) && (j == 2 || j == 10) ? 1 : 0);
    }
  }
}

TEST_F(Arrowhead, EliminatesNoBlockThatNothingWasSeenOf) {
  ArrowEquations equations(kLayout);
  equations.clear();
  ArrowElimination elimination(kLayout);
  EXPECT_FALSE(elimination.eliminate(equations, 1));
}

}  // namespace
}  // namespace calvin
