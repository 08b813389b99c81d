// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the corners of a board scatter by more than their sigmas say, whatever the lens does to
// them.
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/checkerboard/fits/scatter.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::uniform;

// The nodes where a board of 9x6 corners is seen, with their noise, told to `sigma` px.
void put_noisy(const Observation& seen, double sigma, std::normal_distribution<double>& noise,
               scenes::Random& random, detect::Lattice& lattice) {
  lattice.clear();
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    detect::Node node;
    node.x = static_cast<float>(seen.uv[i].u + noise(random));
    node.y = static_cast<float>(seen.uv[i].v + noise(random));
    node.sigma = static_cast<float>(sigma);
    lattice.put({seen.ids[i] % 9, seen.ids[i] / 9}, node);
  }
}

struct Grid {
  const char* model;
  double tilt;    // rad, at most
  double factor;  // of the errors, of what their sigmas say
  // How many numbers tell the scatter: 54 corners less 21 terms of a surface, or before a fisheye
  // the 13 differences over six by five, of which about half are independent.
  double numbers = 66;
  double sigma = 0.01;  // px
};
class Scatter : public ::testing::TestWithParam<Grid> {};
INSTANTIATE_TEST_SUITE_P(Grids, Scatter,
                         ::testing::Values(Grid{"brown5", 0.5, 1}, Grid{"brown5", 1.1, 1},
                                           Grid{"fisheye", 0.5, 1}, Grid{"brown5", 0.7, 3},
                                           Grid{"brown5", 0.7, 1, 66, 0.003}));

TEST_P(Scatter, TellsOfErrorsThatSigmasDoNot) {
  const auto& [model, tilt, factor, numbers, sigma] = GetParam();
  scenes::Random random(2);
  std::normal_distribution<double> noise(0, sigma * factor);
  const Camera camera = scenes::random_camera(model, random);
  detect::Lattice lattice(12);
  double sum = 0;
  double squares = 0;  // of what a corner's error is of its sigma
  const int boards = 60;
  for (int n = 0; n < boards; ++n) {
    const SE3 pose = scenes::random_pose(camera, scenes::kBoard, random, uniform(random, 0, tilt));
    put_noisy(true_observation(camera, scenes::kBoard, pose), sigma, noise, random, lattice);
    const double ratio =
        static_cast<double>(detect::scatter(lattice, camera.image_size())) / factor;
    sum += ratio / boards;
    squares += 1 / (ratio * ratio) / boards;
  }
  std::cout << "  " << sum << ", squares " << squares << '\n';
  EXPECT_NEAR(sum, 1, 0.1);
  // The mean of the inverse of the mean of n squares is n / (n - 2). A view of which the scatter is
  // taken for less than it is would be believed too much.
  const double spread = numbers * std::sqrt(2 / (numbers - 4)) / (numbers - 2);
  EXPECT_NEAR(squares, numbers / (numbers - 2), 4 * spread / std::sqrt(boards));
}

// Some of the corners of a large board before a wide lens, told to a 400th of a pixel: what its
// distortion leaves of a plane is no scatter.
TEST(ScatterOfAPart, IsNotThatOfTheLens) {
  constexpr double kSigma = 0.0025;  // px
  scenes::Random random(4);
  std::normal_distribution<double> noise(0, kSigma);
  const Camera camera = default_camera({1920, 1080}, 80 * std::numbers::pi / 180);
  detect::Lattice lattice(12);
  std::vector<double> ratios;
  while (ratios.size() < 100) {
    const double square = uniform(random, 100, 200);  // px
    const double side = uniform(random, 0, 2 * std::numbers::pi);
    const double tilt = uniform(random, 0, 0.7);
    const SE3 pose = {exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}) *
                          exp_so3({0, 0, uniform(random, 0, 2 * std::numbers::pi)}),
                      Eigen::Vector3d(uniform(random, -0.2, 0.2), uniform(random, -0.1, 0.1),
                                      camera.fx() * scenes::kSquares.size / square)};
    const Observation seen = true_observation(camera, scenes::kBoard, pose);
    if (seen.ids.size() < 25 || seen.ids.size() > 40) continue;
    put_noisy(seen, kSigma, noise, random, lattice);
    ratios.push_back(static_cast<double>(detect::scatter(lattice, camera.image_size())));
  }
  double square = 0;
  for (const double ratio : ratios) square += ratio * ratio / static_cast<double>(ratios.size());
  std::cout << "  " << std::sqrt(square) << '\n';
  EXPECT_NEAR(std::sqrt(square), 1, 0.15);
}

// Nor where the board reaches from one side of a fisheye's view to the other; there is as much
// scatter as there is.
class ScatterBeforeAFisheye : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Factors, ScatterBeforeAFisheye, ::testing::Values(1.0, 3.0));

TEST_P(ScatterBeforeAFisheye, IsNotThatOfTheLens) {
  constexpr double kSigma = 0.005;  // px
  scenes::Random random(5);
  std::normal_distribution<double> noise(0, GetParam() * kSigma);
  const ImageSize size = {1920, 1080};
  detect::Lattice lattice(12);
  double square = 0;
  constexpr int kBoards = 100;
  for (int n = 0; n < kBoards; ++n) {
    const double f = size.width * uniform(random, 0.24, 0.34);
    const Camera camera = Camera::make("fisheye", size,
                                       {f, f, 955, 543, uniform(random, -0.02, 0.02),
                                        uniform(random, -0.005, 0.005), 0, 0})
                              .value();
    // At the nearest 45 degrees to either side of it.
    const double side = uniform(random, 0, 2 * std::numbers::pi);
    const SE3 pose = {exp_so3({0.3 * std::cos(side), 0.3 * std::sin(side), 0}),
                      Eigen::Vector3d(-0.1, -0.06, uniform(random, 0.1, 0.25))};
    const Observation seen = true_observation(camera, scenes::kBoard, pose);
    put_noisy(seen, kSigma, noise, random, lattice);
    const auto ratio = static_cast<double>(detect::scatter(lattice, size));
    square += ratio * ratio / kBoards;
  }
  std::cout << "  " << std::sqrt(square) << '\n';
  EXPECT_NEAR(std::sqrt(square) / GetParam(), 1, 0.15);
}

TEST(ScatterOfFewCorners, IsNotKnown) {
  detect::Lattice lattice(12);
  for (int i = 0; i < 12; ++i) lattice.put({i % 4, i / 4}, {});
  EXPECT_EQ(detect::scatter(lattice, {640, 480}), 1);
}

}  // namespace
}  // namespace calvin
