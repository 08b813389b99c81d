// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The fit of one corner on pictures of exact corners, and how far its sigma is to be trusted.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include <gtest/gtest.h>

#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using detect::Direction;
using detect::SaddleFit;
using scenes::uniform;

struct Picture {
  const char* name;
  double level;     // grey levels, of the middle
  double contrast;  // half of that of the squares
  double blur;      // px
  double gain;      // px by which the bright squares are larger than the dark ones, on each side
  double noise;     // grey levels
  float radius;     // px
  double bound;     // px, of the RMS distance without noise
  bool has_gain = false;  // the fit's
};

double edge(double distance) { return 0.5 * (1 + std::erf(distance / std::numbers::sqrt2)); }

// How likely two normal numbers of correlation r are below a and below b: Plackett's integral of
// their density over the correlation from 0 on, by Simpson's rule.
double below_both(double a, double b, double r) {
  constexpr int kSteps = 32;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double at = r * i / kSteps;
    const double free = 1 - at * at;
    const double density = std::exp(-(a * a - 2 * at * a * b + b * b) / (2 * free)) /
                           (2 * std::numbers::pi * std::sqrt(free));
    sum += density * (i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2);
  }
  return edge(a) * edge(b) + sum * r / (3 * kSteps);
}

// The share of the two squares with a b > 0 in a blurred picture, each of them `gap` px from the
// other; `cosine` of the angle between the normals of their edges.
double two_squares(double a, double b, double gap, double blur, double cosine) {
  return below_both((a - gap) / blur, (b - gap) / blur, cosine) +
         below_both((-a - gap) / blur, (-b - gap) / blur, cosine);
}

// A corner of which one edge is at an angle to the rows, the other one `opening` further.
GrayImage corner_picture(const Picture& p, int side, Pixel at, double angle, double opening,
                         double noise, scenes::Random& random) {
  std::normal_distribution<double> normal(0, 1);
  const double cosine = -std::cos(opening);
  GrayImage image(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double du = x - at.u;
      const double dv = y - at.v;
      const double a = std::cos(angle) * dv - std::sin(angle) * du;
      const double b = du * std::sin(angle + opening) - dv * std::cos(angle + opening);
      const double bright = p.gain > 0 ? 1 - two_squares(a, -b, p.gain, p.blur, -cosine)
                                       : two_squares(a, b, -p.gain, p.blur, cosine);
      const double grey = p.level + p.contrast * (2 * bright - 1) + noise * normal(random);
      image.row(y)[x] = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
    }
  }
  return image;
}

Direction direction(double angle) {
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

class ExactCorners : public ::testing::TestWithParam<Picture> {};
INSTANTIATE_TEST_SUITE_P(
    Pictures, ExactCorners,
    // Rounding to grey levels alone makes 0.001 px at the usual contrast.
    ::testing::Values(Picture{"plain", 125, 95, 1.04, 0, 2, 14, 0.0015},
                      Picture{"large", 125, 95, 1.04, 0, 2, 45, 0.001},
                      Picture{"over_exposed", 325, 247, 1.53, 0, 2, 14, 0.0015},
                      Picture{"under_exposed", -40, 130, 1.53, 0, 2, 14, 0.003},
                      // What the fit does not know of must not pull at the place.
                      Picture{"unknown_ink", 125, 95, 1.04, -1, 2, 14, 0.003},
                      Picture{"ink", 125, 95, 1.04, -1, 2, 14, 0.0015, true},
                      Picture{"light", 150, 95, 0.7, 1.3, 2, 14, 0.0015, true},
                      Picture{"neither", 125, 95, 1.04, 0, 2, 14, 0.0015, true}),
    [](const auto& picture) { return picture.param.name; });

TEST_P(ExactCorners, AreFittedAsWellAsTheNoiseLets) {
  const Picture& p = GetParam();
  const int side = p.radius > 20 ? 141 : 61;  // px
  for (const double noise : {0.0, p.noise}) {
    scenes::Random random(4);
    double square = 0;
    double predicted = 0;
    const int corners = p.radius > 20 && !scenes::full_count() ? 50 : 150;
    int lost = 0;
    for (int n = 0; n < corners; ++n) {
      const double u = side / 2 + uniform(random, -0.5, 0.5);
      const double v = side / 2 + uniform(random, -0.5, 0.5);
      const double angle = uniform(random, 0, 2 * std::numbers::pi);
      const double opening = uniform(random, 1.0, 2.1);
      const GrayImage image = corner_picture(p, side, {u, v}, angle, opening, noise, random);
      SaddleFit fit;
      fit.x = u + uniform(random, -0.3, 0.3);
      fit.y = v + uniform(random, -0.3, 0.3);
      fit.along = direction(angle + 0.03);
      fit.down = direction(angle + opening - 0.03);
      bool good = detect::fit_saddle(image.view(), 8, 8, fit);
      if (p.has_gain) {
        // As Refinement does.
        fit.has_gain = true;
        fit.contrast = 0;
        fit.along_width = fit.down_width = 2;
        good = detect::fit_saddle(image.view(), 8, 16, fit);
      }
      if (!good || !detect::fit_saddle(image.view(), p.radius, 8, fit)) {
        ++lost;
        continue;
      }
      square += (fit.x - u) * (fit.x - u) + (fit.y - v) * (fit.y - v);
      predicted += 2 * static_cast<double>(fit.sigma) * static_cast<double>(fit.sigma);
    }
    EXPECT_EQ(lost, 0);
    const double rms = std::sqrt(square / (corners - lost));
    std::cout << "  noise " << noise << ": RMS " << rms << " px, predicted "
              << std::sqrt(predicted / (corners - lost)) << '\n';
    if (noise == 0) {
      EXPECT_LT(rms, p.bound);
    } else if (p.gain == 0 || p.has_gain) {
      EXPECT_NEAR(std::sqrt(predicted / (corners - lost)) / rms, 1, 0.15);
    }
  }
}

// Edges at an acute angle, the middle between them half way between rows and columns: what one
// knows of u beside v is far better than what one knows of it.
TEST(ObliqueCorners, AreAsFarOffAsTheySay) {
  const Picture p = {"oblique", 125, 95, 1.04, 0, 2, 14, 0};
  constexpr double kOpening = 0.7;
  scenes::Random random(8);
  double square[2] = {0, 0};
  double predicted = 0;
  const int corners = scenes::full_count() ? 3000 : 400;
  for (int n = 0; n < corners; ++n) {
    const Pixel at = {uniform(random, 19.5, 20.5), uniform(random, 19.5, 20.5)};
    const double angle = std::numbers::pi / 4 - kOpening / 2;
    const GrayImage image = corner_picture(p, 41, at, angle, kOpening, p.noise, random);
    SaddleFit fit;
    fit.x = at.u;
    fit.y = at.v;
    fit.along = direction(angle);
    fit.down = direction(angle + kOpening);
    ASSERT_TRUE(detect::fit_saddle(image.view(), 8, 8, fit));
    ASSERT_TRUE(detect::fit_saddle(image.view(), p.radius, 8, fit));
    square[0] += (fit.x - at.u) * (fit.x - at.u) / corners;
    square[1] += (fit.y - at.v) * (fit.y - at.v) / corners;
    predicted += std::pow(static_cast<double>(fit.sigma), 2) / corners;
  }
  // A variance from n numbers is off by sqrt(2 / n) of itself.
  const double spread = std::sqrt(2.0 / corners);
  EXPECT_NEAR(predicted / square[0], 1, 0.05 + 3 * spread);
  EXPECT_NEAR(predicted / square[1], 1, 0.05 + 3 * spread);
}

// A corner in so much noise that neighbours tell its place as well as the picture does: together
// they tell it as well as the sigma says, and better than either.
TEST(ExpectedCorners, AreAsFarOffAsTheySay) {
  const Picture p = {"weak", 125, 20, 1.5, 0, 14, 4, 0};
  constexpr double kExpected = 0.4;  // px
  scenes::Random random(9);
  std::normal_distribution<double> off(0, kExpected);
  const int corners = scenes::full_count() ? 6000 : 1500;
  double square = 0;
  double predicted = 0;
  int fitted = 0;
  for (int n = 0; n < corners; ++n) {
    const Pixel at = {uniform(random, 19.5, 20.5), uniform(random, 19.5, 20.5)};
    const double angle = uniform(random, 0, 2 * std::numbers::pi);
    const double opening = uniform(random, 1.2, 1.9);
    const GrayImage image = corner_picture(p, 41, at, angle, opening, p.noise, random);
    SaddleFit fit;
    fit.x = at.u + off(random);
    fit.y = at.v + off(random);
    fit.along = direction(angle);
    fit.down = direction(angle + opening);
    fit.along_width = fit.down_width = static_cast<float>(p.blur);
    fit.has_expected = true;
    fit.expected = {fit.along,
                    fit.down,
                    fit.along_width,
                    fit.down_width,
                    fit.x,
                    fit.y,
                    static_cast<float>(kExpected)};
    if (!detect::fit_saddle(image.view(), p.radius, 10, fit)) continue;
    square += (fit.x - at.u) * (fit.x - at.u) + (fit.y - at.v) * (fit.y - at.v);
    predicted += 2 * static_cast<double>(fit.sigma) * static_cast<double>(fit.sigma);
    ++fitted;
  }
  EXPECT_GT(fitted, 0.98 * corners);
  const double rms = std::sqrt(square / (2 * fitted));  // px, a coordinate
  std::cout << "  RMS " << rms << " px, predicted " << std::sqrt(predicted / (2 * fitted)) << '\n';
  EXPECT_LT(rms, 0.8 * kExpected);
  EXPECT_NEAR(std::sqrt(predicted / (2 * fitted)) / rms, 1, 0.15);
}

// The dots around a corner of a PuzzleBoard, from which a step of the rows and one of the columns
// go, px.
detect::EdgeDots dots_around(const PuzzleBoard& board, GridPlace p, Direction right,
                             Direction below) {
  constexpr auto kRadius = static_cast<float>(PuzzleBoard::kDotDiameter / 2);
  detect::EdgeDots dots;
  const auto add = [&](bool light, bool on_along, float half) {
    const Direction edge = on_along ? right : below;
    const Direction other = on_along ? below : right;
    dots.all[static_cast<std::size_t>(dots.count++)] = {light,
                                                        on_along,
                                                        {half * edge.x, half * edge.y},
                                                        {kRadius * edge.x, kRadius * edge.y},
                                                        {kRadius * other.x, kRadius * other.y}};
  };
  add(board.is_light_after(p), true, 0.5F);
  add(board.is_light_after({p.col - 1, p.row}), true, -0.5F);
  add(board.is_light_below(p), false, 0.5F);
  add(board.is_light_below({p.col, p.row - 1}), false, -0.5F);
  return dots;
}

// In a window that reaches over the dots of a PuzzleBoard they are taken out, whole and in place.
TEST(DotsOnEdges, LeaveNothingInTheWindow) {
  constexpr float kSquare = 40;  // px
  constexpr double kTurn = 0.35;
  const PuzzleBoard puzzle{6, 5, 0.02};
  const Camera camera = default_camera({640, 480});
  const double away = puzzle.size * camera.parameters()[0] / static_cast<double>(kSquare);
  const SE3 pose(Eigen::AngleAxisd(kTurn, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                 Eigen::Vector3d(-0.04, -0.06, away));
  const GrayImage image = render_board(camera, puzzle, pose, {.noise = 0, .blur = 0.8});
  const auto c = static_cast<float>(std::cos(kTurn));
  const auto s = static_cast<float>(std::sin(kTurn));
  const Board board = puzzle;
  for (int row = 1; row + 1 < puzzle.rows; ++row) {
    for (int col = 1; col + 1 < puzzle.cols; ++col) {
      const Pixel at =
          *camera.project(pose * board.points()[*board.index_of(puzzle.grid().id({col, row}))]);
      SaddleFit fit;
      fit.x = at.u;
      fit.y = at.v;
      fit.along = {c, s};
      fit.down = {-s, c};
      ASSERT_TRUE(detect::fit_saddle(image.view(), 0.25F * kSquare, 8, fit));
      fit.dots =
          dots_around(puzzle, {col, row}, {kSquare * c, kSquare * s}, {-kSquare * s, kSquare * c});
      ASSERT_TRUE(detect::fit_saddle(image.view(), 0.6F * kSquare, 8, fit));
      EXPECT_LT(fit.residual, 0.05F * fit.swing()) << col << " " << row;
      EXPECT_LT(std::hypot(fit.x - at.u, fit.y - at.v), 0.05);
    }
  }
}

// Blur moves an edge that a lens bends to its hollow side, and all corners of a fisheye with them
// towards the middle of the picture.
TEST(BlurBeforeAFisheye, DoesNotMoveCorners) {
  const Camera camera =
      Camera::make("fisheye", {640, 480}, {205, 206, 322, 238, -0.02, 0.005, -0.003, 5e-4}).value();
  const BoardRenderer renderer(camera);
  const Motion motion(MotionKind::kRandom, camera, scenes::kBoard, 3);
  const auto detector = std::move(*make_detector(scenes::kBoard));
  double outwards = 0;
  double square = 0;
  int corners = 0;
  for (int view = 0; view < 60; ++view) {
    const SE3 pose = motion.camera_from_board(view);
    const Observation truth = true_observation(camera, scenes::kBoard, pose);
    const GrayImage image = renderer.render(scenes::kBoard, pose, {.blur = 1.5});
    const Observation seen = detector->detect(image.view()).observation;
    ASSERT_EQ(seen.ids, truth.ids) << view;
    for (std::size_t i = 0; i < seen.uv.size(); ++i) {
      const Eigen::Vector2d off(seen.uv[i].u - truth.uv[i].u, seen.uv[i].v - truth.uv[i].v);
      const Eigen::Vector2d way(truth.uv[i].u - camera.cx(), truth.uv[i].v - camera.cy());
      outwards += off.dot(way.normalized());
      square += off.squaredNorm() / 2;
      ++corners;
    }
  }
  std::cout << "  " << outwards / corners << " px outwards, RMS " << std::sqrt(square / corners)
            << '\n';
  EXPECT_NEAR(outwards / corners, 0, 5e-4);
  EXPECT_LT(std::sqrt(square / corners), 0.0035);
}

// A board that moves by `px` while the shutter is open, and is at `pose` in the middle of that.
GrayImage moving(const Camera& camera, const BoardRenderer& renderer, const SE3& pose, double px) {
  constexpr int kSteps = 24;
  std::vector<double> sums(static_cast<std::size_t>(camera.image_size().width) *
                           static_cast<std::size_t>(camera.image_size().height));
  for (int i = 0; i < kSteps; ++i) {
    SE3 then = pose;
    then.translation.x() += ((i + 0.5) / kSteps - 0.5) * px / camera.fx() * pose.translation.z();
    const GrayImage image = renderer.render(scenes::kBoard, then, {.blur = 0.8});
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += image.pixels[k];
  }
  GrayImage mean(camera.image_size().width, camera.image_size().height);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    mean.pixels[k] = static_cast<std::uint8_t>(std::lround(sums[k] / kSteps));
  }
  return mean;
}

// It turns how all edges look that it is oblique to, which is not to be taken for their bends.
TEST(Motion, DoesNotMoveTheBordersOfABoard) {
  const Camera camera = Camera::make("pinhole", {640, 480}, {600, 600, 319.5, 239.5}).value();
  const BoardRenderer renderer(camera);
  const Motion motion(MotionKind::kRandom, camera, scenes::kBoard, 5);
  const auto detector = std::move(*make_detector(scenes::kBoard));
  double worst = 0;
  int seen = 0;
  for (int view = 0; view < 10; ++view) {
    const SE3 pose = motion.camera_from_board(view);
    const GrayImage image = moving(camera, renderer, pose, 8);
    const Observation found = detector->detect(image.view()).observation;
    if (!found.found()) continue;
    ++seen;
    const Observation truth = true_observation(camera, scenes::kBoard, pose);
    ASSERT_EQ(found.ids, truth.ids) << view;
    double square = 0;
    for (std::size_t i = 0; i < found.uv.size(); ++i) {
      square += (std::pow(found.uv[i].u - truth.uv[i].u, 2) +
                 std::pow(found.uv[i].v - truth.uv[i].v, 2)) /
                static_cast<double>(found.uv.size());
    }
    worst = std::max(worst, std::sqrt(square));
  }
  std::cout << "  " << seen << " views, RMS at most " << worst << " px\n";
  EXPECT_GE(seen, 8);
  EXPECT_LT(worst, 0.03);
}

}  // namespace
}  // namespace calvin
