// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// difference() against cameras whose difference follows from the formulas, and against what a
// solve predicts of itself.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calvin/solve/difference.hpp"
#include "calvin/solve/uncertainty.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

constexpr ImageSize kOdd = {641, 481};

double norm(const std::array<double, 3>& w) { return std::hypot(w[0], w[1], w[2]); }

class EveryModel : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Difference, EveryModel, ::testing::ValuesIn(model_names()),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(EveryModel, HasNoneToItself) {
  Random random(3);
  const Camera camera = scenes::random_camera(GetParam(), random);
  const auto d = difference(camera, camera);
  ASSERT_TRUE(d.has_value()) << d.error().message;
  EXPECT_LT(d->image.max, 1e-6);
  EXPECT_LT(norm(d->rotation), 1e-9);
  EXPECT_EQ(d->cells.size(), static_cast<std::size_t>(65 * 49));
  EXPECT_EQ(d->focus.cells, d->image.cells);
  EXPECT_EQ(d->cells.front().at.u, 0);
  EXPECT_EQ(d->cells.back().at.u, kSize.width - 1);
  EXPECT_EQ(d->cells.back().at.v, kSize.height - 1);
}

TEST_P(EveryModel, OfTheFocalLengthIsKnown) {
  // Du = (u - cx) (fx' / fx - 1): symmetric about the centre of the image, so no rotation helps.
  Random random(4);
  const Camera any = scenes::random_camera(GetParam(), random, kOdd);
  std::vector<double> p = any.parameters();
  p[0] = p[1] = GetParam() == "fisheye" ? 200 : 700;
  p[2] = 320;
  p[3] = 240;
  std::fill(p.begin() + 4, p.end(), 0.0);
  for (std::size_t i = 4; i < p.size(); ++i) {
    const std::string_view name = parameter_names(GetParam())[i];
    if (name == "alpha" || name == "beta") p[i] = any.parameters()[i];
  }
  const Camera a = Camera::make(GetParam(), kOdd, p).value();
  for (const double factor : {1.001, 0.97}) {
    p[0] = p[1] = factor * a.fx();
    const auto d = difference(a, Camera::make(GetParam(), kOdd, p).value());
    ASSERT_TRUE(d.has_value()) << d.error().message;
    EXPECT_NEAR(d->image.max, 400 * std::abs(factor - 1), 1e-6);
    EXPECT_LT(norm(d->rotation), 1e-9);
    for (const Difference::Cell& cell : d->cells) {
      if (!cell.change) continue;
      EXPECT_NEAR(cell.change->u, (factor - 1) * (cell.at.u - 320), 1e-6);
      EXPECT_NEAR(cell.change->v, (factor - 1) * (cell.at.v - 240), 1e-6);
    }
  }
}

// OpenCV's tilted sensor is a pinhole that is turned, seen through a scale and a shift: with
// R = Ry(-tauy) Rx(-taux), u = f (R33 x - R13 z) / z + cx where (x y z) = R ray. So the two cameras
// differ by the turn R alone, however large.
TEST(Difference, OfACameraThatIsTurnedIsTheRotation) {
  for (const auto& [taux, tauy] : {std::pair(0.01, -0.02), std::pair(-0.3, 0.2)}) {
    const Eigen::Matrix3d r = exp_so3({0, -tauy, 0}) * exp_so3({-taux, 0, 0});
    std::vector<double> tilted(18, 0.0);
    tilted[0] = tilted[1] = 600;
    tilted[2] = 330;
    tilted[3] = 250;
    tilted[16] = taux;
    tilted[17] = tauy;
    const Camera a = Camera::make("tilted14", kOdd, tilted).value();
    const std::vector<double> turned = {600 * r(2, 2), 600 * r(2, 2), 330 - 600 * r(0, 2),
                                        250 - 600 * r(1, 2)};
    const Camera b = Camera::make("pinhole", kOdd, turned).value();
    const auto d = difference(a, b);
    ASSERT_TRUE(d.has_value()) << d.error().message;
    EXPECT_LT(d->image.max, 1e-6);
    EXPECT_EQ(d->image.cells, 65 * 49);
    EXPECT_NEAR((exp_so3(Eigen::Vector3d(d->rotation.data())) - r).norm(), 0, 1e-9);
  }
}

TEST(Difference, OfThePrincipalPointIsMostlyARotation) {
  // On a long lens a shift of the image by s px and a turn by s / f differ by the second order in
  // the field: less than s (r / f)^2 with r the way to the corner.
  const Camera a = Camera::make("pinhole", kOdd, {2000, 2000, 320, 240}).value();
  const Camera b = Camera::make("pinhole", kOdd, {2000, 2000, 326, 240}).value();
  const auto d = difference(a, b);
  ASSERT_TRUE(d.has_value()) << d.error().message;
  EXPECT_LT(d->image.max, 6 * std::pow(400.0 / 2000, 2));
  EXPECT_GT(d->image.max, 0.01);
  EXPECT_NEAR(d->rotation[1], -6.0 / 2000, 0.03 * 6 / 2000);
  EXPECT_NEAR(d->rotation[0], 0, 1e-9);
  EXPECT_NEAR(d->rotation[2], 0, 1e-9);
}

// No neighbouring rotation is better: the derivative of the sum of squares vanishes.
TEST(Difference, RotationIsTheBestOneEvenWhenTheDifferenceIsLarge) {
  const Camera a =
      Camera::make("brown5", kOdd, {500, 505, 310, 250, -0.25, 0.08, 1e-3, -1e-3, 0}).value();
  const Camera b = Camera::make("pinhole", kOdd, {620, 600, 420, 160}).value();
  const auto d = difference(a, b);
  ASSERT_TRUE(d.has_value()) << d.error().message;
  const Eigen::Matrix3d best = exp_so3(Eigen::Vector3d(d->rotation.data()));
  const auto rms = [&](const Eigen::Vector3d& w) {
    double squares = 0;
    for (const Difference::Cell& cell : d->cells) {
      const auto at = b.project(exp_so3(w) * best * a.unproject(cell.at).value()).value();
      squares += std::pow(at.u - cell.at.u, 2) + std::pow(at.v - cell.at.v, 2);
    }
    return std::sqrt(squares / static_cast<double>(d->cells.size()));
  };
  EXPECT_NEAR(rms({0, 0, 0}), d->image.rms, 1e-9);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {1e-4, -1e-4, 0.03, -0.03, 0.3, -0.3}) {
      EXPECT_GT(rms(step * Eigen::Vector3d::Unit(axis)), d->image.rms);
    }
  }
}

TEST(Difference, FocusIsWhereTheRotationIsFitted) {
  // The same lens in the left half; k1 apart: with the focus in a corner the corner agrees, and the
  // rest pays for it.
  const Camera a = Camera::make("brown4", kOdd, {500, 500, 320, 240, -0.2, 0.05, 0, 0}).value();
  const Camera b = Camera::make("brown4", kOdd, {500, 500, 320, 240, -0.21, 0.05, 0, 0}).value();
  DifferenceOptions options;
  options.focus = {{{0, 0}, {200, 0}, {200, 200}, {0, 200}},
                   {{0, 0}, {640, 0}, {640, 120}, {0, 120}}};
  const auto whole = difference(a, b);
  const auto corner = difference(a, b, options);
  ASSERT_TRUE(whole.has_value() && corner.has_value());
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < corner->cells.size(); ++i) {
    const Difference::Cell& cell = corner->cells[i];
    EXPECT_EQ(cell.in_focus, cell.at.u <= 200 && cell.at.v <= 120);
    if (!cell.in_focus) continue;
    const Pixel change = whole->cells[i].change.value();
    squares += change.u * change.u + change.v * change.v;
    ++count;
  }
  EXPECT_EQ(corner->focus.cells, count);
  EXPECT_LT(corner->focus.rms, 0.8 * std::sqrt(squares / count));
  EXPECT_GT(corner->image.rms, whole->image.rms);
}

// What both calibrations covered is inside of both polygons.
TEST(Difference, FocusIsWhatAllPolygonsHave) {
  const Camera camera = Camera::make("pinhole", {1281, 961}, {1000, 1000, 640, 480}).value();
  DifferenceOptions options;
  options.columns = 33;
  options.rows = 25;
  options.focus = {{{-1, -1}, {650, -1}, {650, 961}, {-1, 961}},
                   {{-1, -1}, {1281, -1}, {1281, 490}, {-1, 490}}};
  const Difference found = difference(camera, camera, options).value();
  EXPECT_EQ(found.image.cells, 33 * 25);
  EXPECT_EQ(found.focus.cells, 17 * 13);  // to 640 and to 480 px, in steps of 40
  for (const Difference::Cell& cell : found.cells) {
    EXPECT_EQ(cell.in_focus, cell.at.u < 650 && cell.at.v < 490);
  }
}

TEST(Difference, PixelsThatAModelDoesNotKnowAreLeftOut) {
  // The polynomial of `a` has its largest radius at 447 px from the centre of a larger image.
  const Camera a =
      Camera::make("brown4", {1001, 1001}, {500, 500, 500, 500, -0.2, 0, 0, 0}).value();
  const Camera b = Camera::make("pinhole", {1001, 1001}, {500, 500, 500, 500}).value();
  const double limit = 500 * std::sqrt(1 / 0.6) * (1 - 0.2 / 0.6);
  const auto d = difference(a, b);
  ASSERT_TRUE(d.has_value()) << d.error().message;
  int absent = 0;
  for (const Difference::Cell& cell : d->cells) {
    const double r = std::hypot(cell.at.u - 500, cell.at.v - 500);
    if (std::abs(r - limit) < 1) continue;
    EXPECT_EQ(cell.change.has_value(), r < limit) << r;
    absent += cell.change ? 0 : 1;
  }
  EXPECT_GT(absent, 100);
}

TEST(Difference, RefusesWhatCannotBeCompared) {
  const Camera a = Camera::make("pinhole", kOdd, {500, 500, 320, 240}).value();
  const auto other = difference(a, a.scaled({320, 240}));
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(other.error().message.find("scale"), std::string::npos);
  DifferenceOptions options;
  options.columns = 1;
  EXPECT_EQ(difference(a, a, options).error().code, ErrorCode::kInvalidArgument);
  options = {};
  options.focus = {{{700, 500}, {800, 500}, {800, 600}}};
  EXPECT_EQ(difference(a, a, options).error().code, ErrorCode::kDegenerate);
}

// Two solves of one camera from views with noise of their own are sqrt(2) times the expected error
// apart, at its worst place: the largest over the grid of the change's variance along its worse
// direction, over many pairs.
TEST(Difference, OfTwoSolvesIsWhatTheyExpect) {
  Random random(9);
  const Camera truth = scenes::random_camera("brown5", random);
  const auto poses = scenes::random_poses(truth, kBoard, random, 12);
  SolveOptions options;
  options.reject_outliers = false;
  DifferenceOptions grid;
  grid.columns = 33;
  grid.rows = 25;
  const int pairs = scenes::full_count() ? 2000 : 250;
  std::vector<Eigen::Matrix2d> spread;
  double expected = 0;
  for (int i = 0; i < pairs; ++i) {
    std::vector<Camera> cameras;
    for (int k = 0; k < 2; ++k) {
      const auto views = scenes::observe_all(truth, kBoard, poses, 0.1, random);
      const Calibration c = solve(views, kSize, options).value().calibration;
      // Of both: sqrt(2) is in it.
      expected += std::pow(expected_error_anywhere(c).value(), 2) / pairs;
      cameras.push_back(Camera::make(c).value());
    }
    const auto d = difference(cameras[0], cameras[1], grid).value();
    spread.resize(d.cells.size(), Eigen::Matrix2d::Zero());
    for (std::size_t k = 0; k < d.cells.size(); ++k) {
      const Eigen::Vector2d e(d.cells[k].change->u, d.cells[k].change->v);
      spread[k] += e * e.transpose() / pairs;
    }
  }
  double worst = 0;
  for (const Eigen::Matrix2d& m : spread) {
    worst = std::max(worst, (m(0, 0) + m(1, 1)) / 2 + std::hypot((m(0, 0) - m(1, 1)) / 2, m(0, 1)));
  }
  // The sampling error of a standard deviation is 1 / sqrt(2 n).
  EXPECT_NEAR(std::sqrt(worst / expected), 1, 3 / std::sqrt(2.0 * pairs) + 0.02);
}

}  // namespace
}  // namespace calvin
