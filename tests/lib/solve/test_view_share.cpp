// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a view says beside all views, by what its functions have to fulfil: shares that are small,
// large or nothing at all.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "calvin/solve/judge/view_share.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::Random;

constexpr int kDirections = 9;

Eigen::MatrixXd random_matrix(int rows, int columns, Random& random) {
  std::normal_distribution<double> normal(0, 1);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Directions of very different units, as px and coefficients are.
Eigen::MatrixXd random_root(Random& random) {
  const Eigen::MatrixXd m = random_matrix(kDirections, kDirections, random);
  Eigen::VectorXd units(kDirections);
  for (int i = 0; i < kDirections; ++i) units[i] = std::pow(10, 2 - 0.5 * i);
  return units.asDiagonal() * m;
}

// Views with those eigenvalues of their share.
class Shares : public ::testing::TestWithParam<std::vector<double>> {};
INSTANTIATE_TEST_SUITE_P(
    Sizes, Shares,
    ::testing::Values(std::vector<double>{.01, .02, .02, .03, .04, .05, .06, .07, .08},
                      std::vector<double>{1e-8, 1e-6, 1e-4, .001, .01, .1, .2, .3, .4},
                      std::vector<double>{.1, .2, .3, .4, .5, .6, .7, .8, .9},
                      std::vector<double>{0, 0, 0, .01, .02, .03, .04, .05, .06},
                      std::vector<double>{0, 0, 0, 0, .1, .3, .5, .7, .95}));

TEST_P(Shares, FulfilTheirEquations) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::MatrixXd root = random_root(random);
    const Eigen::MatrixXd q =
        Eigen::HouseholderQR<Eigen::MatrixXd>(random_matrix(kDirections, kDirections, random))
            .householderQ();
    const Eigen::VectorXd values =
        Eigen::VectorXd::Map(GetParam().data(), static_cast<Eigen::Index>(GetParam().size()));
    const Eigen::MatrixXd share = q * values.asDiagonal() * q.transpose();
    // What the view tells nothing of has no gradient.
    const Eigen::VectorXd known =
        q * values.cwiseSqrt().asDiagonal() * random_matrix(kDirections, 1, random).col(0);
    const Eigen::MatrixXd inverse = root.inverse();
    const Eigen::MatrixXd information = inverse.transpose() * share * inverse;
    const ViewShare view(root, information, inverse.transpose() * known);
    ASSERT_TRUE(view.valid());
    EXPECT_LT((view.information() - share).norm(), 1e-8);
    EXPECT_LT((view.gradient() - known).norm(), 1e-8);
    ASSERT_TRUE(view.without());
    const Eigen::VectorXd& without = *view.without();
    EXPECT_LT((without - share * without - known).norm(), 1e-7 * known.norm());
    // Half of the way twice is the way.
    const ViewShare again(root, information, inverse.transpose() * view.unabsorbed());
    EXPECT_LT((again.unabsorbed() - without).norm(), 1e-7 * without.norm());
    double squares = 0;
    int directions = 0;
    for (int i = 0; i < kDirections; ++i) {
      if (values[i] < 1e-9) continue;
      squares += std::pow(q.col(i).dot(known), 2) / values[i];
      ++directions;
    }
    EXPECT_NEAR(view.squares(), squares, 1e-4 * squares);
    EXPECT_EQ(view.directions(), directions);
  }
}

// Without a view that is the only one to tell a direction there is no camera, and its own error is
// not known from it.
TEST(ViewShare, ThatIsAllHasNoOthers) {
  Random random(6);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Identity(3, 3);
  Eigen::Vector3d values = {.1, .2, 1};
  const Eigen::Vector3d gradient = {1, 2, 3};
  const ViewShare view(root, values.asDiagonal(), gradient);
  ASSERT_TRUE(view.valid());
  EXPECT_FALSE(view.without());
  EXPECT_NEAR(view.unabsorbed()[2], 3 / std::sqrt(.02), 1e-9);
  EXPECT_NEAR(view.unabsorbed()[0], 1 / std::sqrt(.9), 1e-9);
  values[0] = std::nan("");
  EXPECT_FALSE(ViewShare(root, values.asDiagonal(), gradient).valid());
}

}  // namespace
}  // namespace calvin
