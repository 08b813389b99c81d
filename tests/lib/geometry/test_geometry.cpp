// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigid motions, homographies, polynomial roots.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/covariance.hpp"
#include "calvin/geometry/homography.hpp"
#include "calvin/geometry/polynomial.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin {
namespace {

TEST(So3, LogInvertsExpFromTinyAnglesToPi) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double angle : {0.0, 1e-12, 1e-6, 0.3, 3.0, std::numbers::pi - 1e-9}) {
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d axis =
          Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      const Eigen::Vector3d w = axis * angle;
      EXPECT_LT((log_so3(exp_so3(w)) - w).norm(), 1e-8 * (1 + angle)) << "angle " << angle;
    }
  }
}

TEST(Se3, InverseAndPoseRoundTrip) {
  const SE3 a = to_se3({{0.1, -0.4, 1.2}, {0.3, 0.2, -0.5}});
  const Eigen::Vector3d p(1, 2, 3);
  EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-14);
  const Pose pose = to_pose(a);
  EXPECT_NEAR(pose.rotation[1], -0.4, 1e-14);
  EXPECT_NEAR(pose.translation[2], -0.5, 1e-14);
}

TEST(So3, RotationBetweenTakesOneDirectionToTheOther) {
  const std::vector<Eigen::Vector3d> directions = {{0, 0, 2},   {0, 0, -1},   {1, -2, 3},
                                                   {-1, 2, -3}, {0, 1e-9, 1}, {0, 1e-14, -1}};
  for (const Eigen::Vector3d& from : directions) {
    for (const Eigen::Vector3d& to : directions) {
      const Eigen::Matrix3d r = rotation_between(from, to);
      EXPECT_LT((r * from.normalized() - to.normalized()).norm(), 1e-12);
      EXPECT_NEAR(r.determinant(), 1, 1e-12);
      const double turn = log_so3(r).norm();
      const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
      EXPECT_NEAR(turn, angle, 1e-7);
    }
  }
}

TEST(So3, ClosestRotationIsProper) {
  const Eigen::Matrix3d r = closest_rotation(-Eigen::Matrix3d::Identity());
  EXPECT_NEAR(r.determinant(), 1, 1e-12);
}

TEST(So3, ClosestRotationOfNoNumbersIsNone) {
  for (const double none : {std::nan(""), HUGE_VAL}) {
    Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
    m(1, 2) = none;
    EXPECT_TRUE(closest_rotation(m).array().isNaN().all()) << none;
  }
}

TEST(Covariance, IsToldFromOtherNumbers) {
  const auto is_none = [](std::vector<double> rows, std::size_t size) {
    return no_covariance(rows, size).has_value();
  };
  EXPECT_FALSE(is_none({}, 0));
  EXPECT_FALSE(is_none({0}, 1));
  EXPECT_FALSE(is_none({4, 1, 1, 9}, 2));
  EXPECT_FALSE(is_none({1, 1, 1, 1}, 2));
  EXPECT_FALSE(is_none({0, 0, 0, 9}, 2));
  EXPECT_FALSE(is_none({1, 0.9999, 0.9999, 0.9999, 1, 1, 0.9999, 1, 1}, 3));  // of four digits
  EXPECT_TRUE(is_none({-1}, 1));
  EXPECT_TRUE(is_none({std::nan("")}, 1));
  EXPECT_TRUE(is_none({HUGE_VAL}, 1) || is_none({4, HUGE_VAL, HUGE_VAL, 9}, 2));
  EXPECT_TRUE(is_none({4, 1, 2, 9}, 2));
  EXPECT_TRUE(is_none({4, 7, 7, 9}, 2));
  EXPECT_TRUE(is_none({1, -0.9, -0.9, -0.9, 1, -0.9, -0.9, -0.9, 1}, 3));
}

TEST(Homography, FindsTheMapOfExactPoints) {
  Eigen::Matrix3d h;
  h << 600, 20, 320, -15, 580, 240, 0.2, -0.1, 1;
  std::vector<Pixel> xy;
  std::vector<Pixel> uv;
  for (int i = 0; i < 12; ++i) {
    xy.push_back({0.03 * (i % 4), 0.03 * std::floor(i / 4.0)});
    uv.push_back(transform(h, xy.back()));
  }
  const auto found = fit_homography(xy, uv);
  ASSERT_TRUE(found.has_value()) << found.error().message;
  EXPECT_LT((*found - h).norm(), 1e-6 * h.norm());
}

TEST(Homography, RefusesPointsOnALine) {
  std::vector<Pixel> xy;
  std::vector<Pixel> uv;
  for (int i = 0; i < 6; ++i) {
    xy.push_back({0.1 * i, 0.2 * i});
    uv.push_back({10.0 * i, 5.0 * i});
  }
  const auto found = fit_homography(xy, uv);
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().code, ErrorCode::kDegenerate);
}

TEST(Polynomial, SmallestPositiveRoot) {
  EXPECT_NEAR(smallest_positive_root(std::vector<double>{6, -5, 1}), 2, 1e-12);
  EXPECT_NEAR(smallest_positive_root(std::vector<double>{1, -0.9, 0, 0}), 1 / 0.9, 1e-12);
  EXPECT_TRUE(std::isinf(smallest_positive_root(std::vector<double>{1, 1, 1})));
  EXPECT_TRUE(std::isinf(smallest_positive_root(std::vector<double>{1, 0, 0})));
}

TEST(Polynomial, FindsTheRootsItWasMadeFrom) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-10, 10);
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<double> polynomial = {1};
    double smallest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 1 + trial % 4; ++i) {
      const double root = place(random);
      if (root > 0) smallest = std::min(smallest, root);
      polynomial.push_back(0);
      for (std::size_t k = polynomial.size() - 1; k > 0; --k) {
        polynomial[k] = polynomial[k - 1] - root * polynomial[k];
      }
      polynomial[0] *= -root;
    }
    if (std::isinf(smallest)) {
      EXPECT_TRUE(std::isinf(smallest_positive_root(polynomial)));
    } else {
      EXPECT_NEAR(smallest_positive_root(polynomial), smallest, 1e-6 * smallest) << trial;
    }
  }
}

TEST(Polynomial, TinyLeadingCoefficientsMoveNothing) {
  EXPECT_NEAR(smallest_positive_root(std::vector<double>{1, -0.5, 1e-200, -1e-250}), 2, 1e-12);
  EXPECT_NEAR(smallest_positive_root(std::vector<double>{1, 0, 0, 0, -1e-80}) / 1e20, 1, 1e-12);
}

TEST(Symmetric, ValuesAndVectorsMakeTheMatrixAgain) {
  Eigen::MatrixXd m(3, 3);
  m << 4, 9, 9, 1, 3, 9, -2, 0.5, 7;  // only the lower triangle counts
  const auto eigen = symmetric_eigen(m);
  ASSERT_TRUE(eigen.has_value());
  const Eigen::MatrixXd again =
      eigen->vectors * eigen->values.asDiagonal() * eigen->vectors.transpose();
  EXPECT_NEAR(again(1, 0), 1, 1e-12);
  EXPECT_NEAR(again(0, 2), -2, 1e-12);
  EXPECT_NEAR(again(2, 2), 7, 1e-12);
  EXPECT_LE(eigen->values[0], eigen->values[1]);
  m(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(symmetric_eigen(m).has_value());
}

TEST(ConvexHull, OfASquareWithPointsInsideAndOnItsSides) {
  std::vector<Pixel> points;
  for (int x = 0; x <= 10; ++x) {
    for (int y = 0; y <= 10; ++y) points.push_back({1.0 * x, 1.0 * y});
  }
  const auto hull = convex_hull(points);
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_EQ(polygon_area(hull), 100);
  EXPECT_TRUE(contains(hull, {5, 5}));
  EXPECT_TRUE(contains(hull, {10, 3}));
  EXPECT_FALSE(contains(hull, {10.001, 3}));
}

TEST(ConvexHull, HoldsItsPointsAndIsConvex) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Pixel> points(200);
  for (Pixel& p : points) p = {normal(random), normal(random)};
  const auto hull = convex_hull(points);
  EXPECT_GT(polygon_area(hull), 1);
  for (const Pixel& p : points) EXPECT_TRUE(contains(hull, p));
  for (std::size_t i = 0; i < hull.size(); ++i) {
    auto rest = hull;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_FALSE(contains(rest, hull[i]));
  }
}

TEST(ConvexHull, OfFewOrCollinearPointsHasNoArea) {
  EXPECT_TRUE(convex_hull({}).empty());
  EXPECT_LT(convex_hull({{1, 1}, {1, 1}}).size(), 3u);
  const auto line = convex_hull({{0, 0}, {1, 1}, {2, 2}, {3, 3}});
  EXPECT_LT(line.size(), 3u);
  EXPECT_EQ(polygon_area(line), 0);
  EXPECT_FALSE(contains(line, {1, 1}));
}

}  // namespace
}  // namespace calvin
