// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Factors of small matrices beside Eigen's.
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "calvin/detect/small_factor.hpp"

namespace calvin::detect {
namespace {

template <typename Case>
class SmallFactors : public ::testing::Test {};

template <typename T, int kSize>
struct Case {
  using Number = T;
  static constexpr int kRows = kSize;
};
using Cases = ::testing::Types<Case<float, 2>, Case<float, 8>, Case<float, 9>, Case<double, 8>>;
TYPED_TEST_SUITE(SmallFactors, Cases);

TYPED_TEST(SmallFactors, SolveAsEigenDoes) {
  using T = typename TypeParam::Number;
  constexpr int kSize = TypeParam::kRows;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  const double tolerance = sizeof(T) == sizeof(double) ? 1e-12 : 1e-5;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 100; ++round) {
    const Eigen::Matrix<double, 4 * kSize, kSize> rows =
        Eigen::Matrix<double, 4 * kSize, kSize>::NullaryExpr([&] { return normal(random); });
    const Matrix m = rows.transpose() * rows;
    const Vector right = Vector::NullaryExpr([&] { return normal(random); });
    T upper[kSize * (kSize + 1) / 2];
    int k = 0;
    for (int row = 0; row < kSize; ++row) {
      EXPECT_EQ(k, (SmallFactor<T, kSize>::diagonal(row)));
      for (int col = row; col < kSize; ++col) upper[k++] = static_cast<T>(m(row, col));
    }
    SmallFactor<T, kSize> factor;
    ASSERT_TRUE(factor.compute(upper));
    T x[kSize];
    for (int i = 0; i < kSize; ++i) x[i] = static_cast<T>(right[i]);
    factor.solve(x);
    const Vector expected = m.ldlt().solve(right);
    for (int i = 0; i < kSize; ++i) EXPECT_NEAR(static_cast<double>(x[i]), expected[i], tolerance);
    const Matrix inverse = m.inverse();
    EXPECT_NEAR(static_cast<double>(factor.mean_of_last_variances()),
                inverse.diagonal().template tail<2>().mean(), tolerance);
  }
}

TYPED_TEST(SmallFactors, AreOfPositiveMatricesAlone) {
  using T = typename TypeParam::Number;
  constexpr int kSize = TypeParam::kRows;
  using Factor = SmallFactor<T, kSize>;
  T upper[kSize * (kSize + 1) / 2] = {};
  Factor factor;
  EXPECT_FALSE(factor.compute(upper));
  for (int i = 0; i < kSize; ++i) upper[Factor::diagonal(i)] = 1;
  EXPECT_TRUE(factor.compute(upper));
  // Each of the two diagonal elements is positive, their part of the matrix is not.
  upper[Factor::diagonal(kSize - 2) + 1] = 2;
  EXPECT_FALSE(factor.compute(upper));
  upper[Factor::diagonal(kSize - 2) + 1] = 0;
  upper[Factor::diagonal(kSize - 1)] = std::numeric_limits<T>::quiet_NaN();
  EXPECT_FALSE(factor.compute(upper));
}

}  // namespace
}  // namespace calvin::detect
